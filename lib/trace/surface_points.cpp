// lib/trace/surface_points.cpp -- computes surface points from hits, and rays that leave them.
#include <cmath>

#include "lib/core/lanes.h"
#include "lib/trace/trees.h"

namespace tempolux {
namespace {

/// Smallest barycentric coordinate of a point, which keeps 4e-6 of the triangle's height from the edges. Rounding could
/// put a point at an edge behind the neighbouring wall, and the next ray would leave a closed room.
constexpr float kSmallestBarycentric = 0x1p-18f;

}  // namespace

[[gnu::always_inline]] inline SurfacePoint Tracer::Impl::point_of(const Hit& hit) const {
  const SurfaceArrays& surface = surfaces[hit.surface];
  const auto& corner = surface.triangles[hit.triangle];
  SurfaceArrays::Own own;
  const SurfaceArrays::Corners at = surface.corner_positions(corner, own);
  const __m128 a = lanes::load(*at.a), b = lanes::load(*at.b), c = lanes::load(*at.c);
  float u = std::max(hit.u, kSmallestBarycentric), v = std::max(hit.v, kSmallestBarycentric);
  float w = std::max(1 - hit.u - hit.v, kSmallestBarycentric);
  const float scale = 1 / (u + v + w);
  u *= scale;
  v *= scale;
  w *= scale;
  const auto mix = [&](__m128 at_a, __m128 at_b, __m128 at_c) {
    return at_a * _mm_set1_ps(w) + at_b * _mm_set1_ps(u) + at_c * _mm_set1_ps(v);
  };

  const __m128 sign = _mm_set1_ps(-0.0f);
  __m128 normal_geometric = lanes::normalize(lanes::cross(b - a, c - a));
  if (surface.flipped) normal_geometric = _mm_xor_ps(normal_geometric, sign);
  __m128 normal = normal_geometric;
  if (surface.smooth) {
    const SurfaceArrays::Corners normals = surface.corner_normals(corner, own);
    const __m128 n = lanes::normalize(mix(lanes::load(*normals.a), lanes::load(*normals.b), lanes::load(*normals.c)));
    if (_mm_cvtss_f32(lanes::dot(n, n)) > 0) {
      const __m128 behind = _mm_cmp_ps(lanes::dot(n, normal_geometric), _mm_setzero_ps(), _CMP_LT_OQ);
      normal = _mm_xor_ps(n, _mm_and_ps(behind, sign));
    }
  }

  SurfacePoint point;
  point.position = lanes::to_vec(mix(a, b, c));
  point.normal_geometric = lanes::to_vec(normal_geometric);
  point.normal = lanes::to_vec(normal);
  if (const Vec2* uv = surface.uvs)
    point.uv = {uv[corner[0]].x * w + uv[corner[1]].x * u + uv[corner[2]].x * v,
                uv[corner[0]].y * w + uv[corner[1]].y * u + uv[corner[2]].y * v};
  point.offset =
      surface.instance
          ? surface.instance_offset
          : kOffsetScale * max_component(lanes::to_vec(_mm_max_ps(
                               _mm_max_ps(_mm_andnot_ps(sign, a), _mm_andnot_ps(sign, b)), _mm_andnot_ps(sign, c))));
  point.surface = hit.surface;
  point.triangle = hit.triangle;
  point.object = surface.object;
  point.material = surface.material;
  if (surface.plates) [[unlikely]]
    point.plate = surface.plates[hit.triangle];
  point.u = u;
  point.v = v;
  return point;
}

SurfacePoint Tracer::surface_point(const Hit& hit) const { return impl_->point_of(hit); }

void Tracer::surface_points(std::span<const Hit> hits, SurfacePoint* points) const {
  for (std::size_t i = 0; i < hits.size(); ++i) points[i] = impl_->point_of(hits[i]);
}

Ray spawn_shadow_ray(const SurfacePoint& point, Vec3 target, float target_offset) {
  const Vec3 origin = spawn_ray(point, target - point.position).origin;
  const Vec3 direction = target - origin;
  const float distance = length(direction);
  // The ray ends four offsets of the target before the target, but at least a few ulp of the distance.
  const float stop = distance > 0 ? 1 - std::min(0.5f, 4 * target_offset / distance + 0x1p-20f) : 0;
  return {origin, direction, 0, stop};
}

}  // namespace tempolux
