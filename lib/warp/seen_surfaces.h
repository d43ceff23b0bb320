// lib/warp/seen_surfaces.h -- what a picture shows: depth, object and normal by pixel, and where surfaces end.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "lib/core/vec.h"
#include "lib/image/image.h"
#include "lib/warp/frame_camera.h"

namespace tempolux {

inline constexpr std::uint32_t kNoObject = 0xffffffffu;   ///< id.object where nothing is seen
inline constexpr std::uint32_t kAnyObject = 0xfffffffeu;  ///< of a picture that does not say: it may be any

/// The point that the ray through each pixel's centre meets. Nothing met: depth +inf, object kNoObject, normal 0.
struct SeenSurfaces {
  int width = 0, height = 0;
  std::vector<float> depth;           ///< Z, m
  std::vector<std::uint32_t> object;  ///< empty: not known
  std::vector<Vec3> normal;           ///< unit, world space; empty: not known

  std::size_t pixel_count() const { return depth.size(); }
  std::uint32_t object_at(std::size_t p) const { return object.empty() ? kAnyObject : object[p]; }
  Vec3 normal_at(std::size_t p) const { return normal.empty() ? Vec3{} : normal[p]; }
};

/// One point that a picture shows, to be found in another.
struct FacePoint {
  float depth = 0;
  std::uint32_t object = kNoObject;
  Vec3 normal;  ///< world space; 0: not known
};

/// How far two depths of one smooth surface may be apart within a pixel, as a share of the depth: two pixels' width
/// along the surface, at least a thousandth. `facing` is |n . r| of the surface, `pixel_angle` a pixel's width at depth
/// 1 (docs/methods/ formulas.md); of facing at least .05 counts, as normals interpolated over a mesh turn away farther
/// than its triangles do.
inline float depth_tolerance(float pixel_angle, float facing) {
  return std::max(1e-3f, 2 * pixel_angle / std::max(facing, 0.05f));
}

/// Cosine below which two normals belong to two faces: their irradiance differs (docs/methods/formulas.md).
inline constexpr float kSameFace = 0.9f;

/// May two pictures' objects be one? What is not known agrees with all.
inline bool may_be_same(std::uint32_t a, std::uint32_t b) { return a == b || a == kAnyObject || b == kAnyObject; }

/// Are two points, at most a pixel or two apart in a picture, on one face of one object? tolerance: of depths,
/// relative.
inline bool same_face(const FacePoint& a, const FacePoint& b, float tolerance) {
  if (!may_be_same(a.object, b.object)) return false;
  if (!(a.depth < INFINITY && b.depth < INFINITY)) return a.depth == b.depth;
  if (!(std::abs(a.depth - b.depth) <= tolerance * a.depth)) return false;
  const bool known = length2(a.normal) > 0 && length2(b.normal) > 0;
  return !known || dot(a.normal, b.normal) >= kSameFace;
}

/// One entry a pixel. 1: the pixel's whole area shows the face that its centre shows, judged by the centres of the 8
/// around it. What is narrower than a pixel may lie between two centres unseen.
std::vector<std::uint8_t> whole_pixels(const SeenSurfaces& seen, const FrameCamera& camera);

/// Depth, object and normal from the channels of a frame: Z, 1e10 and more for nothing; id.object and N if they are
/// there, N brought to length 1. Throws InputError, beginning with `name`, if there is no depth, or a depth or normal
/// that cannot be.
SeenSurfaces seen_in(const Image& image, const std::string& name);

}  // namespace tempolux
