// lib/trace/triangle_hit.h -- where a ray meets a triangle, by arithmetic that is the same on every processor.
#pragma once

#include <algorithm>

#include "lib/core/lanes.h"

namespace tempolux {

/// Where a line meets the plane of a triangle.
struct TriangleHit {
  float t = 0;         ///< multiple of the line's direction; NaN or infinite if the line is parallel to the plane
  float u = 0, v = 0;  ///< barycentric coordinates of corners b and c

  /// True if the place lies outside the triangle. False for NaN.
  bool outside() const { return (u < 0) | (v < 0) | (u + v > 1); }
};

/// The point origin + t direction in the plane of the triangle a, b, c: Cramer's rule with e1 = b - a, e2 = c - a,
/// s = origin - a, p = direction x e2, q = s x e1 and the determinant e1 . p. Every number is a double, so only the
/// last roundings to float are seen. Additions, multiplications and divisions round alike on every processor. Source:
/// Moeller and Trumbore, Fast, Minimum Storage Ray/Triangle Intersection, 1997.
inline TriangleHit meet_plane(const Vec3& origin, const Vec3& direction, const Vec3& a, const Vec3& b, const Vec3& c) {
  const __m256d corner = lanes::load_double(a), way = lanes::load_double(direction),
                e1 = lanes::load_double(b) - corner, e2 = lanes::load_double(c) - corner,
                s = lanes::load_double(origin) - corner, p = lanes::cross(way, e2), q = lanes::cross(s, e1);
  // The four dot products of t, u, v and the determinant, as (x + y) + (z + 0), then all over the determinant.
  const __m256d t_u = _mm256_hadd_pd(e2 * q, s * p), v_det = _mm256_hadd_pd(way * q, e1 * p),
                all = _mm256_permute2f128_pd(t_u, v_det, 0x20) + _mm256_permute2f128_pd(t_u, v_det, 0x31);
  alignas(16) float tuv[4];
  _mm_store_ps(tuv, _mm256_cvtpd_ps(all / _mm256_permute4x64_pd(all, _MM_SHUFFLE(3, 3, 3, 3))));
  return {tuv[0], tuv[1], tuv[2]};
}

/// The hit of a ray that Embree lets meet the triangle. Embree decides in single precision, so the ray may pass the
/// triangle by a rounding error. Its hit is then the place of the triangle's border with the barycentric coordinates
/// brought into [0, 1], and t the multiple of the direction that comes nearest to this place: in the plane of a
/// triangle that is seen at a grazing angle, the ray would be met far away from the triangle.
inline TriangleHit meet_triangle(const Vec3& origin, const Vec3& direction, const Vec3& a, const Vec3& b,
                                 const Vec3& c) {
  TriangleHit hit = meet_plane(origin, direction, a, b, c);
  if (!hit.outside()) return hit;
  const double u = std::max(0.0, double(hit.u)), v = std::max(0.0, double(hit.v)), all = std::max(1.0, u + v);
  const Vec3d corner(a), way(direction);
  const Vec3d place = corner + (Vec3d(b) - corner) * (u / all) + (Vec3d(c) - corner) * (v / all);
  return {float(dot(place - Vec3d(origin), way) / dot(way, way)), float(u / all), float(v / all)};
}

}  // namespace tempolux
