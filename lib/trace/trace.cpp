// lib/trace/trace.cpp -- builds the search trees of a frame and intersects rays with them; the only file that includes
// Embree.
#include "lib/trace/trace.h"

#include <embree3/rtcore.h>

#include <bit>
#include <cmath>
#include <string>

#include "formats/error.h"
#include "lib/core/box_corners.h"
#include "lib/core/check.h"
#include "lib/core/random.h"
#include "lib/image/texture_images.h"
#include "lib/scene/texture_lookup.h"
#include "lib/trace/trees.h"

namespace tempolux {
namespace {

constexpr unsigned kAllBlend = 1;  ///< RTCRay::id of a ray with all_blend

/// kOffsetScale of instances: the share of the sum in instance_offset().
constexpr float kInstanceOffsetScale = 2 * kOffsetScale;

/// A number in [0, 1) that depends on the bits of ray and triangle only. So whether a ray hits a triangle does not
/// depend on the order in which Embree finds hits, or on the thread.
float chance(const RTCRay& ray, std::uint32_t surface, std::uint32_t triangle) {
  std::uint64_t key = mix64((std::uint64_t(surface) << 32 | triangle) + 0x616c706861ull);
  for (const float x : {ray.org_x, ray.org_y, ray.org_z, ray.dir_x, ray.dir_y, ray.dir_z})
    key = mix64(key ^ std::bit_cast<std::uint32_t>(x));
  return float(key >> 40) * 0x1p-24f;
}

/// Embree's filter for surfaces with alpha: rejects a hit in a hole (MASK), or with probability 1 - alpha (BLEND). Must
/// not throw, so build() has decoded the texture.
void pass_by_alpha(const RTCFilterFunctionNArguments* arguments) {
  const auto& alpha = *static_cast<const AlphaSurface*>(arguments->geometryUserPtr);
  for (unsigned i = 0; i < arguments->N; ++i) {
    if (arguments->valid[i] == 0) continue;
    const RTCHit hit = rtcGetHitFromHitN(arguments->hit, arguments->N, i);
    const float coverage = coverage_at(*alpha.frame, alpha.surface, hit.primID, hit.u, hit.v);
    if (coverage >= 1) continue;
    const RTCRay ray = rtcGetRayFromRayN(arguments->ray, arguments->N, i);
    if (!(ray.id == kAllBlend ? coverage > 0 : chance(ray, alpha.surface, hit.primID) < coverage))
      arguments->valid[i] = 0;
  }
}

/// True if the ray is finite, t_min >= 0, and its numbers are so small that Embree's squared lengths stay finite.
/// Comparisons with NaN are false.
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

bool may_hit(const Tree& tree, const RTCRay& ray) {
  return tree.may_hit({ray.org_x, ray.org_y, ray.org_z}, {ray.dir_x, ray.dir_y, ray.dir_z}, ray.tnear, ray.tfar);
}

/// The surface of a hit: the geometry in this tree, or the instance in whose own tree the hit was found.
std::uint32_t surface_of(const Tree& tree, std::uint32_t geometry, std::uint32_t instance) {
  return tree.first_surface + (instance == RTC_INVALID_GEOMETRY_ID ? geometry : instance);
}

bool intersect_tree(const Tree& tree, RTCRayHit& query, Hit& hit) {
  query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
  query.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  rtcIntersect1(tree.scene, &context, &query);
  if (query.hit.geomID == RTC_INVALID_GEOMETRY_ID) return false;
  hit = {query.ray.tfar, surface_of(tree, query.hit.geomID, query.hit.instID[0]), query.hit.primID, query.hit.u,
         query.hit.v};
  return true;
}

constexpr std::size_t kPacket = 8;

/// Eight rays in Embree's layout. Unusable rays, and lanes after the end of a list, have `valid` 0, and plain numbers
/// with which Embree can compute.
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

  /// Finds hits in this tree that are closer than earlier ones, and shortens the rays to them. everywhere: the tree
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
    // Packets marked as coherent visit the tree in another order than single rays, and the order decides between
    // surfaces at equal distance.
    context.flags = RTC_INTERSECT_CONTEXT_FLAG_INCOHERENT;
    rtcIntersect8(active, tree.scene, &context, &query);
    for (std::size_t i = 0; i < kPacket; ++i) {
      if (!active[i] || query.hit.geomID[i] == RTC_INVALID_GEOMETRY_ID) continue;
      if (hits[i].surface != kNone && !(query.ray.tfar[i] < limit[i])) continue;
      hits[i] = {query.ray.tfar[i], surface_of(tree, query.hit.geomID[i], query.hit.instID[0][i]), query.hit.primID[i],
                 query.hit.u[i], query.hit.v[i]};
    }
  }
};

}  // namespace

/// The instruction set is fixed, since wider instructions of some processors round hits differently and do not make
/// single rays faster. It is the set that this program is compiled for.
Forest::Forest() : device(rtcNewDevice("isa=avx2")) {
  if (!device) throw ResourceError("Embree: cannot make a device");
}

Forest::~Forest() {
  for (const auto& [primitive, shared] : shared_trees)
    if (shared.scene) rtcReleaseScene(shared.scene);
  rtcReleaseDevice(device);
}

StaticTree::Kept::~Kept() {
  if (tree.scene) rtcReleaseScene(tree.scene);
}

Tracer::Impl::~Impl() {
  if (moving.scene) rtcReleaseScene(moving.scene);
}

bool StaticTree::Kept::holds_for(const SceneFrame& frame) const {
  const auto same = [](const Surface& a, const Surface& b) {
    return a.primitive == b.primitive && a.positions.data() == b.positions.data() &&
           a.scene_from_node == b.scene_from_node;
  };
  return !filtered && surfaces.size() == frame.static_count &&
         std::equal(surfaces.begin(), surfaces.end(), frame.surfaces.begin(), same) && !passable(frame);
}

bool StaticTree::Kept::passable(const SceneFrame& frame) {
  return std::any_of(frame.surfaces.begin(), frame.surfaces.begin() + std::ptrdiff_t(frame.static_count),
                     [&](const Surface& s) { return lets_rays_pass(frame.materials[s.material]); });
}

StaticTree::StaticTree() = default;
StaticTree::~StaticTree() = default;

void Tracer::Impl::throw_on_error() const {
  const RTCError error = rtcGetDeviceError(forest->device);
  if (error == RTC_ERROR_NONE) return;
  if (error == RTC_ERROR_OUT_OF_MEMORY) throw ResourceError("building the search tree: out of memory");
  throw ResourceError("building the search tree: Embree error " + std::to_string(int(error)));
}

RTCGeometry Tracer::Impl::triangles_of(const Primitive& primitive, const Vec3* positions) {
  RTCGeometry geometry = rtcNewGeometry(forest->device, RTC_GEOMETRY_TYPE_TRIANGLE);
  // Embree reads vertices in 16-byte loads, so there must be padding after the last vertex: the vertices are copied.
  auto* vertices = static_cast<Vec3*>(rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                                                              sizeof(Vec3), primitive.positions.size()));
  if (vertices) std::copy_n(positions, primitive.positions.size(), vertices);
  rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, primitive.triangles.data(), 0,
                             sizeof primitive.triangles[0], primitive.triangles.size());
  return geometry;
}

const SharedTree& Tracer::Impl::shared_tree(const Primitive& primitive) {
  SharedTree& shared = forest->shared_trees[&primitive];
  if (shared.scene) return shared;
  shared.scene = rtcNewScene(forest->device);
  rtcSetSceneBuildQuality(shared.scene, RTC_BUILD_QUALITY_MEDIUM);
  rtcSetSceneFlags(shared.scene, RTC_SCENE_FLAG_ROBUST);
  const RTCGeometry geometry = triangles_of(primitive, primitive.positions.data());
  rtcCommitGeometry(geometry);
  rtcAttachGeometry(shared.scene, geometry);
  rtcReleaseGeometry(geometry);
  throw_on_error();
  rtcCommitScene(shared.scene);
  throw_on_error();
  for (const Vec3& p : primitive.positions) shared.bounds.add(Vec3d(p));
  shared.reach = float(max_component(max(abs(shared.bounds.lower), abs(shared.bounds.upper))));
  return shared;
}

void Tracer::Impl::attach_instance(Tree& tree, const Surface& surface, unsigned id) {
  const SharedTree& shared = shared_tree(*surface.primitive);
  const RTCGeometry geometry = rtcNewGeometry(forest->device, RTC_GEOMETRY_TYPE_INSTANCE);
  rtcSetGeometryInstancedScene(geometry, shared.scene);
  const Affine& m = surface.scene_from_node;
  const float rows[12] = {float(m.row[0].x), float(m.row[0].y), float(m.row[0].z), float(m.translation.x),
                          float(m.row[1].x), float(m.row[1].y), float(m.row[1].z), float(m.translation.y),
                          float(m.row[2].x), float(m.row[2].y), float(m.row[2].z), float(m.translation.z)};
  rtcSetGeometryTransform(geometry, 0, RTC_FORMAT_FLOAT3X4_ROW_MAJOR, rows);
  rtcCommitGeometry(geometry);
  rtcAttachGeometryByID(tree.scene, geometry, id);
  rtcReleaseGeometry(geometry);
  throw_on_error();
  for_corners(m, shared.bounds, [&](Vec3d corner) { tree.bounds.add(Vec3(corner)); });
}

float Tracer::Impl::instance_offset(const Surface& surface) const {
  const Affine& m = surface.scene_from_node;
  const double stretch = std::sqrt(std::max({length2(m.row[0]), length2(m.row[1]), length2(m.row[2])}));
  const double reach = double(forest->shared_trees.at(surface.primitive).reach);
  return kInstanceOffsetScale * float(max_component(abs(m.translation)) + 1.8 * stretch * reach);
}

void Tracer::Impl::build(Tree& tree, std::size_t first, std::size_t last) {
  tree.first_surface = std::uint32_t(first);
  if (first == last) return;
  tree.scene = rtcNewScene(forest->device);
  // The build of low quality would be faster, but aborts in Debian's Embree 3.13 if all meshes lie in one plane.
  rtcSetSceneBuildQuality(tree.scene, RTC_BUILD_QUALITY_MEDIUM);
  rtcSetSceneFlags(tree.scene, RTC_SCENE_FLAG_ROBUST);
  for (std::size_t s = first; s < last; ++s) {
    const Surface& surface = frame->surfaces[s];
    if (surface.instanced()) {
      attach_instance(tree, surface, unsigned(s - first));
      continue;
    }
    const RTCGeometry geometry = triangles_of(*surface.primitive, surface.positions.data());
    for (const Vec3 p : surface.positions) tree.bounds.add(p);
    if (const Material& material = frame->materials[surface.material]; lets_rays_pass(material)) {
      if (material.textures && material.textures->base_color)  // decoded here, since the filter must not throw
        frame->images->pyramid(material.textures->base_color.image, base_color_transfer(material));
      alpha.push_back({frame, std::uint32_t(s)});
      rtcSetGeometryUserData(geometry, &alpha.back());
      rtcSetGeometryIntersectFilterFunction(geometry, pass_by_alpha);
      rtcSetGeometryOccludedFilterFunction(geometry, pass_by_alpha);
    }
    rtcCommitGeometry(geometry);
    rtcAttachGeometryByID(tree.scene, geometry, unsigned(s - first));
    rtcReleaseGeometry(geometry);
    throw_on_error();
  }
  rtcCommitScene(tree.scene);
  throw_on_error();
  const Vec3 largest = max(abs(tree.bounds.lower), abs(tree.bounds.upper));
  const float margin = 0x1p-18f * max_component(largest);
  tree.bounds = {tree.bounds.lower - Vec3{margin, margin, margin}, tree.bounds.upper + Vec3{margin, margin, margin}};
}

Tracer::Tracer(const SceneFrame& frame) : impl_(std::make_unique<Impl>()) {
  StaticTree none;
  build(frame, none);
}

Tracer::Tracer(const SceneFrame& frame, StaticTree& static_scene) : impl_(std::make_unique<Impl>()) {
  build(frame, static_scene);
}

void Tracer::build(const SceneFrame& frame, StaticTree& static_scene) {
  impl_->frame = &frame;
  if (!static_scene.kept_ || !static_scene.kept_->holds_for(frame)) {
    static_scene.kept_.reset();  // freed before the next tree is built, so that memory need not hold both
    impl_->forest = std::make_shared<Forest>();
    const auto made = std::make_shared<StaticTree::Kept>();
    made->forest = impl_->forest;
    made->surfaces.assign(frame.surfaces.begin(), frame.surfaces.begin() + std::ptrdiff_t(frame.static_count));
    made->filtered = StaticTree::Kept::passable(frame);
    impl_->build(made->tree, 0, frame.static_count);
    static_scene.kept_ = made;
  }
  impl_->static_scene = static_scene.kept_;
  impl_->forest = impl_->static_scene->forest;
  impl_->fixed = impl_->static_scene->tree;
  impl_->build(impl_->moving, frame.static_count, frame.surfaces.size());
  for (const Surface& surface : frame.surfaces) {
    impl_->surfaces.emplace_back(surface);
    impl_->panes |= may_be_pane(frame.materials[surface.material]);
    if (surface.instanced()) impl_->surfaces.back().instance_offset = impl_->instance_offset(surface);
  }
}

Tracer::~Tracer() = default;
Tracer::Tracer(Tracer&&) noexcept = default;

bool Tracer::intersect(const Ray& ray, Hit& hit) const {
  if (!usable(ray)) {
    impl_->refused.fetch_add(1, std::memory_order_relaxed);
    return false;
  }
  // The first call shortens the ray, so the second call reports closer hits only.
  RTCRayHit query{to_embree(ray), {}};
  bool found = false;
  if (impl_->fixed.exists()) found = intersect_tree(impl_->fixed, query, hit);
  if (impl_->moving.exists() && may_hit(impl_->moving, query.ray)) {
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
    if (tree == &impl_->moving && !may_hit(*tree, query)) continue;
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
