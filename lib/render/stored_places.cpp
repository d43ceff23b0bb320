#include "lib/render/stored_places.h"

#include <algorithm>
#include <cmath>

#include "lib/scene/same_surfaces.h"

namespace tempolux {
namespace {

/// `v` turned by the rotation that turns the unit vector `from` into `to` on the shortest way.
Vec3 turned(Vec3 v, Vec3 from, Vec3 to) {
  const Vec3 axis = cross(from, to);
  const float cosine = dot(from, to);
  if (!(cosine > -0.9999f)) return -v;
  // Rodrigues' formula with the axis' length as sine: v cos + axis x v + axis (axis . v) / (1 + cos).
  return v * cosine + cross(axis, v) + axis * (dot(axis, v) / (1 + cosine));
}

}  // namespace

StoredPlaces::StoredPlaces(const SceneFrame& here, const Tracer& stored) : stored_(stored) {
  const std::vector<Surface>& others = stored.frame().surfaces;
  for (const Surface* const same : same_surfaces(here, stored.frame()))
    surface_.push_back(same ? std::uint32_t(same - others.data()) : kNone);
}

StoredPlaces::Place StoredPlaces::of(const SurfacePoint& hit, Vec3 geometric, Vec3 shading) const {
  const std::uint32_t surface = surface_[hit.surface];
  if (surface == kNone) return {hit, geometric, shading};
  const SurfacePoint there = stored_.surface_point({0, surface, hit.triangle, hit.u, hit.v});
  const float side = dot(geometric, hit.normal_geometric) < 0 ? -1.0f : 1.0f;
  return {there, there.normal_geometric * side, normalize(turned(shading, hit.normal, there.normal))};
}

}  // namespace tempolux
