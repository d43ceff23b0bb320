// lib/warp/seen_surfaces.h -- the surfaces that a picture shows: depth, object and normal by pixel, and where surfaces
// end.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "lib/core/vec.h"
#include "lib/image/image.h"
#include "lib/image/pixel_surfaces.h"
#include "lib/warp/frame_camera.h"

namespace tempolux {

inline constexpr std::uint32_t kNoObject = 0xffffffffu;   ///< id.object where no surface is seen
inline constexpr std::uint32_t kAnyObject = 0xfffffffeu;  ///< id.object is unknown: it may be any object

/// The surface point at each pixel's centre. Where no surface is seen: depth +inf, object kNoObject, normal 0.
struct SeenSurfaces {
  int width = 0, height = 0;
  std::vector<float> depth;           ///< Z, m
  std::vector<std::uint32_t> object;  ///< empty: unknown
  std::vector<Vec3> normal;           ///< unit, world space; empty: unknown

  std::size_t pixel_count() const { return depth.size(); }
  std::uint32_t object_at(std::size_t p) const { return object.empty() ? kAnyObject : object[p]; }
  Vec3 normal_at(std::size_t p) const { return normal.empty() ? Vec3{} : normal[p]; }
};

/// A point that a picture shows, to be found in another picture.
struct FacePoint {
  float depth = 0;
  std::uint32_t object = kNoObject;
  Vec3 normal;  ///< world space; 0: unknown
};

/// Largest relative difference of two depths on one smooth surface within a pixel: two pixel widths along the surface,
/// but at least a thousandth (docs/methods/formulas.md). `facing` is |n . r| of the surface, `pixel_angle` a pixel's
/// width at depth 1. facing counts as at least .05, because interpolated normals may turn farther away than the
/// triangles.
inline float depth_tolerance(float pixel_angle, float facing) {
  return std::max(1e-3f, 2 * pixel_angle / std::max(facing, 0.05f));
}

/// Two normals with a smaller cosine belong to different faces, which have different irradiance
/// (docs/methods/formulas.md).
inline constexpr float kSameFace = PixelSurfaces::kSameNormal;

/// True if two objects may be the same one; an unknown object may be any.
inline bool may_be_same(std::uint32_t a, std::uint32_t b) { return a == b || a == kAnyObject || b == kAnyObject; }

/// True if two points, at most two pixels apart in a picture, are on one face of one object. `tolerance`: relative
/// difference of depths.
inline bool same_face(const FacePoint& a, const FacePoint& b, float tolerance) {
  if (!may_be_same(a.object, b.object)) return false;
  if (!(a.depth < INFINITY && b.depth < INFINITY)) return a.depth == b.depth;
  if (!(std::abs(a.depth - b.depth) <= tolerance * a.depth)) return false;
  const bool known = length2(a.normal) > 0 && length2(b.normal) > 0;
  return !known || dot(a.normal, b.normal) >= kSameFace;
}

/// One entry per pixel; 1: the centres of the pixel and of its 8 neighbours show one face, so the whole area of the
/// pixel shows this face. A surface narrower than a pixel that lies between the centres is missed.
std::vector<std::uint8_t> whole_pixels(const SeenSurfaces& seen, const FrameCamera& camera);

/// Reads depth, object and normal from the channels of a frame: Z (1e10 and more: no surface) and, if there, id.object
/// and N, which is normalised. Throws InputError, beginning with `name`, if there is no depth, or a depth or normal is
/// invalid.
SeenSurfaces seen_in(const Image& image, const std::string& name);

}  // namespace tempolux
