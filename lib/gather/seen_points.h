// lib/gather/seen_points.h -- the surface points that the pixels of a picture see.
#pragma once

#include <cstdint>
#include <functional>
#include <iterator>
#include <optional>
#include <vector>

#include "lib/core/random.h"
#include "lib/scene/surface_point.h"

namespace tempolux {

/// A surface point that a camera sees at a pixel, directly or through mirrors and glass.
struct SeenPoint {
  SurfacePoint surface;
  Vec3 normal;             ///< shading normal on the side that is seen
  float footprint = 0;     ///< m: size of a pixel at the point
  bool by_choice = false;  ///< true if the path chose one of several directions, or one of the two sides of a surface
  /// The path's throughput [1] between point and camera: transmittance and reflectance on the path, divided by the
  /// probabilities of the chosen branches. With Look::random the mean of passed x (radiance of the point) is the
  /// radiance that the camera receives.
  Rgb passed{1.0f};
  bool mirrored = false;  ///< true if the camera sees the point by mirrors or glass
  /// True if the point lies on the far side of a surface that transmits diffusely (diffuse_transmission.h).
  bool far_side = false;
};

/// A raster position of a picture, in pixels. Where the path forks (glass, gloss, paper), `random` chooses the branch;
/// without `random` the path takes the branch of higher probability.
struct Look {
  float x = 0, y = 0;
  std::optional<PathRandom> random;
};
/// Finds the point that a raster position sees; empty if no indirect light is needed there. Must be thread-safe.
using PixelView = std::function<std::optional<SeenPoint>(const Look&)>;

/// The properties of a pixel's seen point that decide whether an edge lies between two pixels.
struct Glimpse {
  Vec3 position, normal;  ///< scene space, m; unit
  float footprint = 0;    ///< m
  std::uint32_t object = 0;
  bool any = false, by_choice = false;

  Glimpse() = default;
  explicit Glimpse(const SeenPoint& seen)
      : position(seen.surface.position),
        normal(seen.normal),
        footprint(seen.footprint),
        object(seen.surface.object),
        any(true),
        by_choice(seen.by_choice) {}
  /// True if an edge may lie between the centres of these two neighbouring pixels: another object, normals more than 26
  /// degrees apart, or a step of more than two footprints.
  bool parted_from(const Glimpse& other) const;
};

/// Pixels at edges, row by row. If two pixels that share a side show different surfaces (parted_from), both are edge
/// pixels. A pixel whose path chose one of several directions at a surface (SeenPoint::by_choice) is one, too.
std::vector<std::size_t> edge_pixels(const std::vector<Glimpse>& glimpses, int width, int height);

/// Positions within an edge pixel [pixels] that are tested besides its centre. The frame's samples lie anywhere in the
/// pixel and may see surfaces that the centre does not.
inline constexpr Vec2 kWithin[] = {{0.125f, 0.625f}, {0.375f, 0.125f}, {0.625f, 0.875f}, {0.875f, 0.375f}};
inline constexpr std::uint32_t kEdgeLooks = std::size(kWithin);
/// The centre of a pixel; pixel = y width + x.
Look centre_look(std::size_t pixel, int width);
/// Raster position number k < kEdgeLooks of an edge pixel.
Look edge_look(std::size_t pixel, int width, std::uint32_t k);

}  // namespace tempolux
