// lib/trace/build_trees.cpp -- builds the search trees of a frame: static and moving surfaces, instances, and filters
// for alpha.
#include <bit>
#include <string>

#include "formats/error.h"
#include "lib/core/random.h"
#include "lib/image/texture_images.h"
#include "lib/scene/texture_lookup.h"
#include "lib/trace/trees.h"

namespace tempolux {
namespace {

/// kOffsetScale for instances, relative to the sum in instance_offset.
constexpr float kInstanceOffsetScale = 2 * kOffsetScale;

/// A number in [0, 1) from the bits of ray and triangle: the same ray hits the same triangle or passes it, in whatever
/// order Embree finds hits, on any thread.
float chance(const RTCRay& ray, std::uint32_t surface, std::uint32_t triangle) {
  std::uint64_t key = mix64((std::uint64_t(surface) << 32 | triangle) + 0x616c706861ull);
  for (const float x : {ray.org_x, ray.org_y, ray.org_z, ray.dir_x, ray.dir_y, ray.dir_z})
    key = mix64(key ^ std::bit_cast<std::uint32_t>(x));
  return float(key >> 40) * 0x1p-24f;
}

/// Embree's filter for surfaces with alpha: rejects a hit where the surface is cut out (MASK), or with probability 1 -
/// alpha (BLEND). Never throws: the texture was decoded before.
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

}  // namespace

Forest::Forest() {
  if (!device) throw ResourceError("Embree: cannot make a device");
}

Forest::~Forest() {
  for (const auto& [primitive, shared] : shared_trees)
    if (shared.scene) rtcReleaseScene(shared.scene);
  rtcReleaseDevice(device);
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
  // Embree reads vertices in 16-byte loads, so the last one needs padding: the vertices are copied.
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
  for (int corner = 0; corner < 8; ++corner)
    tree.bounds.add(Vec3(m.point({corner & 1 ? shared.bounds.upper.x : shared.bounds.lower.x,
                                  corner & 2 ? shared.bounds.upper.y : shared.bounds.lower.y,
                                  corner & 4 ? shared.bounds.upper.z : shared.bounds.lower.z})));
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
  // Not the fast build: in Debian's Embree 3.13 it aborts by an assertion if all meshes lie in one plane.
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

}  // namespace tempolux
