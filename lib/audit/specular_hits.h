// lib/audit/specular_hits.h -- surfaces that the camera sees in mirrors and glass; the light of photons there.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "formats/photons/photons.h"
#include "lib/render/camera_view.h"
#include "lib/render/path_tracer.h"
#include "lib/transport/specular_chain.h"

namespace tempolux {

/// The Lambert lobes that camera paths meet after events S. No ray connects a photon to the camera by mirrors and
/// smooth glass. So each place x_i at which such a path ends receives the photons in a disc around it. Its radius r_i
/// is a quarter of the width of a pixel's footprint at the length of the path, times the root of the number of pixels
/// per path. A photon of flux F in the disc adds to the sum over the pixels of layer specular
///
///     w_i rho_i / pi F / (pi r_i^2)     w_i: the path's weight, times pixels per path
///
/// The sum over photons is the layer without the lamps and the sky that paths see by events S alone
/// (Layers::mirrored), seen as if each pixel were blurred by its disc.
class SpecularHits {
 public:
  /// Traces `count` paths from pixels of the mask (empty: all pixels) at whose centre, or at the centre of a
  /// neighbouring pixel, the camera sees a surface with S lobes. All arguments but the mask must outlive this object.
  SpecularHits(const RenderScene& scene, const CameraView& view, std::span<const std::uint8_t> mask, std::size_t count,
               std::uint64_t seed);
  std::size_t size() const { return hits_.size(); }
  /// Appends the photon's contributions with the index of their hit: mean channels, W/m^2/sr summed over pixels. wi:
  /// the photon's direction, if the map stores directions.
  void add(const formats::Photon& photon, std::optional<Vec3> wi,
           std::vector<std::pair<std::uint32_t, double>>& to) const;

 private:
  struct HitPlace {
    ShadingPoint x;
    Vec3 from;            ///< where the path's last part begins
    Vec3 normal, smooth;  ///< normal: of the triangle, on the side that is seen
    Rgb weight;           ///< w_i rho_i / pi / (pi r_i^2)
    float radius;
  };
  struct InCell {
    std::uint64_t cell;
    std::uint32_t hit;
  };
  void follow(const RenderScene& scene, const Ray& ray, const PixelRandom& random, RayCone cone, double pixels_of_path,
              std::vector<HitPlace>& found) const;
  void sort_into_cells();

  bool sees(const HitPlace& hit, Vec3 place, Vec3 normal) const;

  const Tracer& tracer_;
  std::vector<HitPlace> hits_;
  std::vector<InCell> cells_;  ///< each hit in all cells that its disc may touch; sorted
  std::vector<int> sizes_;     ///< exponents: a disc of radius r lies in cells of the size 2^e > 2 r
};

}  // namespace tempolux
