// lib/trace/trace.cpp -- builds the search trees of a frame and intersects rays with them; the only file that includes
// Embree.
#include "lib/trace/trace.h"

#include <embree3/rtcore.h>
#include <immintrin.h>

#include <bit>
#include <cmath>
#include <cstddef>
#include <algorithm>
#include <string>

#include "formats/error.h"
#include "lib/core/box_corners.h"
#include "lib/core/check.h"
#include "lib/core/random.h"
#include "lib/image/texture_images.h"
#include "lib/scene/texture_lookup.h"
#include "lib/trace/trees.h"
#include "lib/trace/triangle_hit.h"

namespace tempolux {
namespace {

/// kOffsetScale of instances: the share of the sum in instance_offset().
constexpr float kInstanceOffsetScale = 2 * kOffsetScale;

/// Embree computes distances with an estimate of a reciprocal, whose last bits differ between makers of processors. So
/// Embree's distance must not decide which hit is nearest: hits that Embree finds at most this share of the distance
/// behind the nearest hit are measured, too. Embree's distance errs by 4 ulp (2^-21), divided by the cosine between the
/// ray and the normal. The share exceeds this error if the cosine is above 1/128.
constexpr float kMargin = 0x1p-14f;
/// Embree's range of a ray is longer than the ray's own range by this share at both ends, so that our own arithmetic
/// decides at the ends. Makers differ by 2 ulp; this share is 4 ulp. With a larger share shadow rays would often meet
/// the lamp at which they end.
constexpr float kEnds = 0x1p-21f;

/// Robust: no ray slips between two triangles that share an edge.
const RTCSceneFlags kSceneFlags = RTC_SCENE_FLAG_ROBUST | RTC_SCENE_FLAG_CONTEXT_FILTER_FUNCTION;

/// A number in [0, 1) that depends on the bits of ray and triangle only. So whether a ray hits a triangle does not
/// depend on the order in which Embree finds hits, or on the thread.
float chance(const Ray& ray, std::uint32_t surface, std::uint32_t triangle) {
  std::uint64_t key = mix64((std::uint64_t(surface) << 32 | triangle) + 0x616c706861ull);
  for (const float x : {ray.origin.x, ray.origin.y, ray.origin.z, ray.direction.x, ray.direction.y, ray.direction.z})
    key = mix64(key ^ std::bit_cast<std::uint32_t>(x));
  return float(key >> 40) * 0x1p-24f;
}

/// True if the ray is finite, t_min >= 0, and its numbers are so small that Embree's squared lengths stay finite.
/// Comparisons with NaN are false. The eight numbers of a Ray are compared at once.
bool usable(const Ray& ray) {
  constexpr float kLargest = 1e18f;
  static_assert(offsetof(Ray, direction) == 12 && offsetof(Ray, t_min) == 24 && offsetof(Ray, t_max) == 28);
  const __m256 numbers = _mm256_loadu_ps(&ray.origin.x);
  const __m256 low = _mm256_setr_ps(-kLargest, -kLargest, -kLargest, -kLargest, -kLargest, -kLargest, 0, -INFINITY),
               high = _mm256_setr_ps(kLargest, kLargest, kLargest, kLargest, kLargest, kLargest, INFINITY, INFINITY);
  return _mm256_movemask_ps(
             _mm256_and_ps(_mm256_cmp_ps(numbers, low, _CMP_GE_OQ), _mm256_cmp_ps(numbers, high, _CMP_LE_OQ))) == 0xff;
}

/// Order of hits: by distance; at equal distance by surface, so that what stands comes before what moves, then by
/// triangle.
bool before(const Hit& a, const Hit& b) {
  return a.t != b.t ? a.t < b.t : a.surface != b.surface ? a.surface < b.surface : a.triangle < b.triangle;
}

}  // namespace

/// A ray on its way through the trees. Embree finds triangles and calls a filter for each; the filter decides by our
/// own arithmetic. It must not throw, so build() has decoded the textures that it reads.
struct Tracer::Impl::Query : RTCIntersectContext {
  const Impl& scene;
  const Ray& ray;
  std::uint32_t first_surface = 0;  ///< of the tree

  Query(const Impl& scene_, const Ray& ray_, RTCFilterFunctionN decide) : scene(scene_), ray(ray_) {
    rtcInitIntersectContext(this);
    filter = decide;
  }

  /// The ray as Embree reads it.
  void write(RTCRay& r) const {
    _mm_storeu_ps(&r.org_x, _mm_loadu_ps(&ray.origin.x));  // and tnear, which the next line sets
    r.tnear = ray.t_min * (1 - kEnds);
    _mm_storeu_ps(&r.dir_x, _mm_loadu_ps(&ray.direction.x));  // and time
    r.time = 0;
    r.tfar = ray.t_max * (1 + kEnds);
    r.mask = 0xffffffffu;
    r.id = r.flags = 0;
  }

  /// The surface of the triangle that Embree has found: the geometry in this tree, or the instance in whose own tree
  /// the triangle was found.
  std::uint32_t surface_of(const RTCFilterFunctionNArguments& found) const {
    const unsigned instance = instID[0], geometry = RTCHitN_geomID(found.hit, 1, 0);
    return first_surface + (instance == RTC_INVALID_GEOMETRY_ID ? geometry : instance);
  }

  bool in_range(float t) const { return t > ray.t_min && t < ray.t_max; }

  /// Where the ray meets a triangle of a surface that is no instance.
  TriangleHit meet(const SurfaceArrays& surface, std::uint32_t triangle) const {
    const auto& corner = surface.triangles[triangle];
    return meet_plane(ray.origin, ray.direction, surface.positions[corner[0]], surface.positions[corner[1]],
                      surface.positions[corner[2]]);
  }

  /// The hit that Embree has found on any surface. False if it is not in the ray's range or there is nothing by alpha:
  /// a hole (MASK), or with probability 1 - alpha (BLEND).
  [[gnu::noinline]] bool measure(const RTCFilterFunctionNArguments& found, Hit& hit) const {
    hit.surface = surface_of(found);
    hit.triangle = RTCHitN_primID(found.hit, 1, 0);
    const SurfaceArrays& surface = scene.surfaces[hit.surface];
    SurfaceArrays::Own own;
    const SurfaceArrays::Corners at = surface.corner_positions(surface.triangles[hit.triangle], own);
    const TriangleHit met = meet_triangle(ray.origin, ray.direction, *at.a, *at.b, *at.c);
    hit.t = met.t;
    hit.u = met.u;
    hit.v = met.v;
    if (!in_range(hit.t)) return false;
    if (!surface.passable) return true;
    const float coverage = coverage_at(*scene.frame, hit.surface, hit.triangle, hit.u, hit.v);
    return coverage >= 1 || (ray.all_blend ? coverage > 0 : chance(ray, hit.surface, hit.triangle) < coverage);
  }
};

/// Keeps the first hit in the order of `before`.
struct Tracer::Impl::NearestQuery : Query {
  Hit nearest;       ///< surface kNone, t infinite: none yet
  RTCRayHit embree;  ///< take() shortens the ray. What Embree writes into the hit is not read

  NearestQuery(const Impl& scene_, const Ray& ray_) : Query(scene_, ray_, take) {
    nearest.t = INFINITY;
    write(embree.ray);
    embree.hit.geomID = embree.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
  }

  /// Embree's filter. Most surfaces need no call from here, so that no register is saved.
  static void take(const RTCFilterFunctionNArguments* found) {
    auto& query = *static_cast<NearestQuery*>(found->context);
    const std::uint32_t number = query.surface_of(*found);
    const SurfaceArrays& surface = query.scene.surfaces[number];
    if (surface.instance || surface.passable) [[unlikely]]
      return take_measured(found);
    const std::uint32_t triangle = RTCHitN_primID(found->hit, 1, 0);
    const TriangleHit met = query.meet(surface, triangle);
    if (met.outside()) [[unlikely]]
      return take_measured(found);
    query.keep(*found, {met.t, number, triangle, met.u, met.v}, query.in_range(met.t));
  }
  [[gnu::noinline]] static void take_measured(const RTCFilterFunctionNArguments* found) {
    auto& query = *static_cast<NearestQuery*>(found->context);
    Hit hit;
    const bool there = query.measure(*found, hit);
    query.keep(*found, hit, there);
  }
  void keep(const RTCFilterFunctionNArguments& found, const Hit& hit, bool there) {
    if (!there || !before(hit, nearest)) {
      found.valid[0] = 0;
      return;
    }
    nearest = hit;
    RTCRayN_tfar(found.ray, 1, 0) = hit.t * (1 + kMargin);
  }
};

/// Takes any hit.
struct Tracer::Impl::AnyQuery : Query {
  RTCRay embree;

  AnyQuery(const Impl& scene_, const Ray& ray_) : Query(scene_, ray_, take) { write(embree); }

  /// Embree's filter. Only near the ends of the ray's range a hit is measured.
  static void take(const RTCFilterFunctionNArguments* found) {
    const auto& query = *static_cast<const AnyQuery*>(found->context);
    const float about = RTCRayN_tfar(found->ray, 1, 0);
    const bool inside = about > query.ray.t_min * (1 + kMargin) && about < query.ray.t_max * (1 - kMargin);
    Hit hit;
    if (!(inside && !query.scene.surfaces[query.surface_of(*found)].passable) && !query.measure(*found, hit))
      found->valid[0] = 0;
  }
};

namespace {

/// False only if the ray misses the tree's box: a few operations instead of a walk through the tree. A ray in the plane
/// of a face gives 0 x infinity = NaN, in whose place max and min take the ray's ends, as second argument.
bool may_hit(const Tree& tree, const RTCRay& ray) {
  const __m128 origin = _mm_loadu_ps(&ray.org_x), inverse = _mm_div_ps(_mm_set1_ps(1), _mm_loadu_ps(&ray.dir_x));
  const __m128 a = _mm_mul_ps(_mm_sub_ps(_mm_load_ps(tree.lower), origin), inverse),
               b = _mm_mul_ps(_mm_sub_ps(_mm_load_ps(tree.upper), origin), inverse);
  __m128 enter = _mm_max_ps(_mm_blendv_ps(a, b, inverse), _mm_set1_ps(ray.tnear)),
         leave = _mm_min_ps(_mm_blendv_ps(b, a, inverse), _mm_set1_ps(ray.tfar));
  enter = _mm_max_ps(enter, _mm_max_ps(_mm_shuffle_ps(enter, enter, 1), _mm_shuffle_ps(enter, enter, 2)));
  leave = _mm_min_ps(leave, _mm_min_ps(_mm_shuffle_ps(leave, leave, 1), _mm_shuffle_ps(leave, leave, 2)));
  return _mm_comile_ss(enter, leave);
}

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
  return surfaces.size() == frame.static_count &&
         std::equal(surfaces.begin(), surfaces.end(), frame.surfaces.begin(), same);
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
  rtcSetSceneFlags(shared.scene, kSceneFlags);
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
  rtcSetSceneFlags(tree.scene, kSceneFlags);
  for (std::size_t s = first; s < last; ++s) {
    const Surface& surface = frame->surfaces[s];
    if (surface.instanced()) {
      attach_instance(tree, surface, unsigned(s - first));
      continue;
    }
    const RTCGeometry geometry = triangles_of(*surface.primitive, surface.positions.data());
    for (const Vec3 p : surface.positions) tree.bounds.add(p);
    rtcCommitGeometry(geometry);
    rtcAttachGeometryByID(tree.scene, geometry, unsigned(s - first));
    rtcReleaseGeometry(geometry);
    throw_on_error();
  }
  rtcCommitScene(tree.scene);
  throw_on_error();
  const Vec3 largest = max(abs(tree.bounds.lower), abs(tree.bounds.upper));
  const float margin = 0x1p-18f * max_component(largest);
  for (int axis = 0; axis < 3; ++axis) {
    tree.lower[axis] = tree.bounds.lower[axis] - margin;
    tree.upper[axis] = tree.bounds.upper[axis] + margin;
  }
}

Tracer::Tracer(const SceneFrame& frame) : impl_(std::make_unique<Impl>()) {
  StaticTree none;
  build(frame, none);
}

Tracer::Tracer(const SceneFrame& frame, StaticTree& static_scene) : impl_(std::make_unique<Impl>()) {
  build(frame, static_scene);
}

namespace {

/// Surfaces whose material allows plates.
std::vector<std::uint32_t> glass_of(const SceneFrame& frame, std::size_t first, std::size_t last) {
  std::vector<std::uint32_t> glass;
  for (std::size_t s = first; s < last; ++s)
    if (may_be_plate(frame.materials[frame.surfaces[s].material])) glass.push_back(std::uint32_t(s));
  return glass;
}

}  // namespace

void Tracer::build(const SceneFrame& frame, StaticTree& static_scene) {
  impl_->frame = &frame;
  if (!static_scene.kept_ || !static_scene.kept_->holds_for(frame)) {
    static_scene.plates_.reset();
    static_scene.kept_.reset();  // freed before the next tree is built, so that memory need not hold both
    impl_->forest = std::make_shared<Forest>();
    const auto made = std::make_shared<StaticTree::Kept>();
    made->forest = impl_->forest;
    made->surfaces.assign(frame.surfaces.begin(), frame.surfaces.begin() + std::ptrdiff_t(frame.static_count));
    impl_->build(made->tree, 0, frame.static_count);
    static_scene.kept_ = made;
  }
  impl_->static_scene = static_scene.kept_;
  impl_->forest = impl_->static_scene->forest;
  impl_->fixed = impl_->static_scene->tree;
  impl_->surfaces.reserve(frame.surfaces.size());
  impl_->add_surfaces(0, frame.static_count);
  // Before there is a moving tree: what moves must not decide whether a static solid is a plate.
  const std::vector<std::uint32_t> glass = glass_of(frame, 0, frame.static_count);
  if (!static_scene.plates_ || static_scene.plates_->searched != glass)
    static_scene.plates_ =
        std::make_shared<const StaticTree::Plates>(StaticTree::Plates{glass, free_plates(*this, glass)});
  impl_->static_plates = static_scene.plates_;
  impl_->build(impl_->moving, frame.static_count, frame.surfaces.size());
  impl_->add_surfaces(frame.static_count, frame.surfaces.size());
  impl_->moving_plates = free_plates(*this, glass_of(frame, frame.static_count, frame.surfaces.size()));
  impl_->use_plates(impl_->static_plates->found);
  impl_->use_plates(impl_->moving_plates);
}

/// Lays out the surfaces of a tree that has been built.
void Tracer::Impl::add_surfaces(std::size_t first, std::size_t last) {
  for (std::size_t s = first; s < last; ++s) {
    const Surface& surface = frame->surfaces[s];
    const Material& material = frame->materials[surface.material];
    surfaces.emplace_back(surface);
    panes |= may_be_pane(material);
    if (lets_rays_pass(material)) {
      surfaces.back().passable = true;
      if (material.textures && material.textures->base_color)  // decoded here, since Embree's filters must not throw
        frame->images->pyramid(material.textures->base_color.image, base_color_transfer(material));
    }
    if (surface.instanced()) surfaces.back().instance_offset = instance_offset(surface);
  }
}

void Tracer::Impl::use_plates(const PlatesOfSurfaces& plates) {
  for (const auto& [surface, thickness] : plates) surfaces[surface].plates = thickness.data(), panes = true;
}

Tracer::~Tracer() = default;
Tracer::Tracer(Tracer&&) noexcept = default;

bool Tracer::intersect(const Ray& ray, Hit& hit) const {
  if (!usable(ray)) {
    impl_->refused.fetch_add(1, std::memory_order_relaxed);
    return false;
  }
  Impl::NearestQuery query(*impl_, ray);
  for (const Tree* tree : {&impl_->fixed, &impl_->moving}) {
    if (!tree->exists() || (tree == &impl_->moving && !may_hit(*tree, query.embree.ray))) continue;
    query.first_surface = tree->first_surface;
    rtcIntersect1(tree->scene, &query, &query.embree);  // shortens the ray for the next tree
  }
  if (query.nearest.surface == kNone) return false;
  hit = query.nearest;
  return true;
}

void Tracer::intersect(std::span<const Ray> rays, std::span<Hit> hits) const {
  TEMPOLUX_CHECK(rays.size() == hits.size());
  for (std::size_t i = 0; i < rays.size(); ++i)
    if (!intersect(rays[i], hits[i])) hits[i] = {};
}

bool Tracer::occluded(const Ray& ray) const {
  if (!usable(ray)) {
    impl_->refused.fetch_add(1, std::memory_order_relaxed);
    return true;
  }
  Impl::AnyQuery query(*impl_, ray);
  for (const Tree* tree : {&impl_->fixed, &impl_->moving}) {
    if (!tree->exists() || (tree == &impl_->moving && !may_hit(*tree, query.embree))) continue;
    query.first_surface = tree->first_surface;
    rtcOccluded1(tree->scene, &query, &query.embree);
    if (query.embree.tfar < 0) return true;
  }
  return false;
}

std::uint64_t Tracer::refused_ray_count() const { return impl_->refused.load(); }
const SceneFrame& Tracer::frame() const { return *impl_->frame; }
bool Tracer::has_panes() const { return impl_->panes; }

bool Tracer::may_pass(const Hit& hit) const {
  const SurfaceArrays& surface = impl_->surfaces[hit.surface];
  return (surface.plates && surface.plates[hit.triangle] > 0) || may_be_pane(impl_->frame->materials[surface.material]);
}

bool Tracer::is_plate(std::uint32_t surface) const {
  const float* const plates = impl_->surfaces[surface].plates;
  return plates && std::all_of(plates, plates + impl_->frame->surfaces[surface].primitive->triangles.size(),
                               [](float thickness) { return thickness > 0; });
}

}  // namespace tempolux
