// lib/trace/surface_points.cpp -- computes surface points from hits, and rays that leave them.
#include <cmath>

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
  const Vec3 a = *at.a, b = *at.b, c = *at.c;
  float u = std::max(hit.u, kSmallestBarycentric), v = std::max(hit.v, kSmallestBarycentric);
  float w = std::max(1 - hit.u - hit.v, kSmallestBarycentric);
  const float scale = 1 / (u + v + w);
  u *= scale;
  v *= scale;
  w *= scale;

  // Both normals stay in registers until `point` is filled: copying a vector that was just stored stalls.
  Vec3 normal_geometric = normalize(cross(b - a, c - a));
  if (surface.flipped) normal_geometric = -normal_geometric;
  Vec3 normal = normal_geometric;
  if (surface.smooth) {
    const SurfaceArrays::Corners normals = surface.corner_normals(corner, own);
    const Vec3 n = normalize(*normals.a * w + *normals.b * u + *normals.c * v);
    if (length2(n) > 0) {
      const bool behind = dot(n, normal_geometric) < 0;
      normal = {behind ? -n.x : n.x, behind ? -n.y : n.y, behind ? -n.z : n.z};
    }
  }

  SurfacePoint point;
  point.position = a * w + b * u + c * v;
  point.normal_geometric = normal_geometric;
  point.normal = normal;
  if (const Vec2* uv = surface.uvs)
    point.uv = {uv[corner[0]].x * w + uv[corner[1]].x * u + uv[corner[2]].x * v,
                uv[corner[0]].y * w + uv[corner[1]].y * u + uv[corner[2]].y * v};
  point.offset =
      surface.instance ? surface.instance_offset : kOffsetScale * max_component(max(max(abs(a), abs(b)), abs(c)));
  point.surface = hit.surface;
  point.triangle = hit.triangle;
  point.object = surface.object;
  point.material = surface.material;
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
