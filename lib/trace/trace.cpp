// lib/trace/trace.cpp -- intersects rays with the search trees.
#include "lib/trace/trace.h"

#include <cmath>

#include "lib/core/check.h"
#include "lib/trace/trees.h"

namespace tempolux {
namespace {

/// True if the ray is finite, t_min >= 0, and so small that Embree's squared lengths stay finite. The comparison of the
/// sum is false for NaN.
bool usable(const Ray& ray) {
  constexpr float kLargest = 1e18f;
  const auto sum = [](Vec3 v) { return std::abs(v.x) + std::abs(v.y) + std::abs(v.z); };
  return sum(ray.origin) < kLargest && sum(ray.direction) < kLargest && ray.t_min >= 0 && !std::isnan(ray.t_max);
}

RTCRay to_embree(const Ray& ray) {
  RTCRay r;
  r.org_x = ray.origin.x;
  r.org_y = ray.origin.y;
  r.org_z = ray.origin.z;
  r.tnear = ray.t_min;
  r.dir_x = ray.direction.x;
  r.dir_y = ray.direction.y;
  r.dir_z = ray.direction.z;
  r.tfar = ray.t_max;
  r.time = 0;
  r.mask = 0xffffffffu;
  r.id = ray.all_blend ? kAllBlend : 0;
  r.flags = 0;
  return r;
}

bool intersect_tree(const Tree& tree, RTCRayHit& query, Hit& hit) {
  query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
  query.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  rtcIntersect1(tree.scene, &context, &query);
  if (query.hit.geomID == RTC_INVALID_GEOMETRY_ID) return false;
  hit = {query.ray.tfar, tree.surface(query.hit.geomID, query.hit.instID[0]), query.hit.primID, query.hit.u,
         query.hit.v};
  return true;
}

constexpr std::size_t kPacket = 8;

/// Eight rays in Embree's layout. Unusable rays, and lanes after the end of a list, have valid 0: Embree must not
/// compute with their numbers.
struct Packet {
  RTCRayHit8 query;
  alignas(32) int valid[kPacket];

  bool may_hit(const Tree& tree, std::size_t i) const {
    return query.ray.tfar[i] > query.ray.tnear[i] &&
           tree.may_hit({query.ray.org_x[i], query.ray.org_y[i], query.ray.org_z[i]},
                        {query.ray.dir_x[i], query.ray.dir_y[i], query.ray.dir_z[i]}, query.ray.tnear[i],
                        query.ray.tfar[i]);
  }

  void set(std::size_t i, const Ray& ray, bool use) {
    query.ray.org_x[i] = use ? ray.origin.x : 0;
    query.ray.org_y[i] = use ? ray.origin.y : 0;
    query.ray.org_z[i] = use ? ray.origin.z : 0;
    query.ray.dir_x[i] = use ? ray.direction.x : 0;
    query.ray.dir_y[i] = use ? ray.direction.y : 0;
    query.ray.dir_z[i] = use ? ray.direction.z : 1;
    query.ray.tnear[i] = use ? ray.t_min : 0;
    query.ray.tfar[i] = use ? ray.t_max : 0;
    query.ray.time[i] = 0;
    query.ray.mask[i] = 0xffffffffu;
    query.ray.id[i] = ray.all_blend ? kAllBlend : 0;
    query.ray.flags[i] = 0;
    valid[i] = use ? -1 : 0;
  }

  /// Finds hits in this tree that are nearer than earlier ones, and shortens the rays to them. everywhere: the tree
  /// fills the scene, so testing its box would cost more than it saves.
  void intersect(const Tree& tree, bool everywhere, Hit* hits) {
    bool any = false;
    alignas(32) int active[kPacket];
    float limit[kPacket];
    for (std::size_t i = 0; i < kPacket; ++i) {
      limit[i] = query.ray.tfar[i];
      active[i] = valid[i] && (everywhere || may_hit(tree, i)) ? -1 : 0;
      any |= active[i] != 0;
      query.hit.geomID[i] = RTC_INVALID_GEOMETRY_ID;
      query.hit.instID[0][i] = RTC_INVALID_GEOMETRY_ID;
    }
    if (!any) return;
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    // Coherent packets visit the tree in an order of their own, which decides between equally near surfaces.
    context.flags = RTC_INTERSECT_CONTEXT_FLAG_INCOHERENT;
    rtcIntersect8(active, tree.scene, &context, &query);
    for (std::size_t i = 0; i < kPacket; ++i) {
      if (!active[i] || query.hit.geomID[i] == RTC_INVALID_GEOMETRY_ID) continue;
      if (hits[i].surface != kNone && !(query.ray.tfar[i] < limit[i])) continue;
      hits[i] = {query.ray.tfar[i], tree.surface(query.hit.geomID[i], query.hit.instID[0][i]), query.hit.primID[i],
                 query.hit.u[i], query.hit.v[i]};
    }
  }
};

}  // namespace

bool Tracer::intersect(const Ray& ray, Hit& hit) const {
  if (!usable(ray)) {
    impl_->refused.fetch_add(1, std::memory_order_relaxed);
    return false;
  }
  // The first call shortens the ray, so the second call reports strictly nearer hits only.
  RTCRayHit query{to_embree(ray), {}};
  bool found = false;
  if (impl_->fixed.exists()) found = intersect_tree(impl_->fixed, query, hit);
  if (impl_->moving.exists() && impl_->moving.may_hit(query.ray)) {
    if (found && query.ray.tfar <= query.ray.tnear) return true;
    Hit nearer;
    const float limit = query.ray.tfar;
    if (intersect_tree(impl_->moving, query, nearer) && (!found || nearer.t < limit)) {
      hit = nearer;
      found = true;
    }
  }
  return found;
}

void Tracer::intersect(std::span<const Ray> rays, std::span<Hit> hits) const {
  TEMPOLUX_CHECK(rays.size() == hits.size());
  for (std::size_t first = 0; first < rays.size(); first += kPacket) {
    const std::size_t count = std::min(kPacket, rays.size() - first);
    Packet packet;
    for (std::size_t i = 0; i < kPacket; ++i) {
      const bool use = i < count && usable(rays[first + i]);
      packet.set(i, rays[first + (i < count ? i : 0)], use);
      if (i < count && !use) impl_->refused.fetch_add(1, std::memory_order_relaxed);
    }
    Hit found[kPacket];
    if (impl_->fixed.exists()) packet.intersect(impl_->fixed, true, found);
    if (impl_->moving.exists()) packet.intersect(impl_->moving, false, found);
    std::copy(found, found + count, hits.begin() + std::ptrdiff_t(first));
  }
}

bool Tracer::occluded(const Ray& ray) const {
  if (!usable(ray)) {
    impl_->refused.fetch_add(1, std::memory_order_relaxed);
    return true;
  }
  for (const Tree* tree : {&impl_->fixed, &impl_->moving}) {
    if (!tree->exists()) continue;
    RTCRay query = to_embree(ray);
    if (tree == &impl_->moving && !tree->may_hit(query)) continue;
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    rtcOccluded1(tree->scene, &context, &query);
    if (query.tfar < 0) return true;
  }
  return false;
}

std::uint64_t Tracer::refused_ray_count() const { return impl_->refused.load(); }
const SceneFrame& Tracer::frame() const { return *impl_->frame; }
bool Tracer::has_panes() const { return impl_->panes; }

}  // namespace tempolux
