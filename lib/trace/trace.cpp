#include "lib/trace/trace.h"

#include <embree3/rtcore.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <bit>
#include <deque>
#include <string>
#include <unordered_map>
#include <vector>

#include "formats/error.h"
#include "lib/core/check.h"
#include "lib/core/random.h"
#include "lib/image/texture_images.h"
#include "lib/scene/texture_lookup.h"

namespace tempolux {
namespace {

/// Rays leave a surface this fraction of the largest coordinate of its triangle above it: 16 ulp of float32,
/// four times the rounding of a point made from barycentrics and of Embree's own arithmetic.
constexpr float kOffsetScale = 0x1p-20f;

/// The same for instances, of the sum that instance_offset says.
constexpr float kInstanceOffsetScale = 2 * kOffsetScale;

/// Points keep this much of each corner (4e-6 of the triangle's height away from its edges): rounding at an
/// edge must not put a point behind the neighbouring wall, from where the next ray would leave a closed room.
constexpr float kSmallestBarycentric = 0x1p-18f;

/// Finite, t_min >= 0, and small enough that Embree's squared lengths stay finite. A sum that is below a number
/// has no NaN in it.
bool usable(const Ray& ray) {
  constexpr float kLargest = 1e18f;
  const auto sum = [](Vec3 v) { return std::abs(v.x) + std::abs(v.y) + std::abs(v.z); };
  return sum(ray.origin) < kLargest && sum(ray.direction) < kLargest && ray.t_min >= 0 && !std::isnan(ray.t_max);
}

struct Tree {
  RTCScene scene = nullptr;
  std::uint32_t first_surface = 0;
  Box3 bounds;   ///< a little larger than what is in it

  bool exists() const { return scene != nullptr; }

  /// The surface of a hit: its geometry in this tree, or that of the instance in whose own tree it was found.
  std::uint32_t surface(std::uint32_t geometry, std::uint32_t instance) const {
    return first_surface + (instance == RTC_INVALID_GEOMETRY_ID ? geometry : instance);
  }

  /// False only if the ray does not come near: a few operations instead of a walk through the tree. Distances are
  /// within 3 ulp and the box is 2^-18 larger than its content; 0 x infinity (a ray in a face's plane) is NaN, which
  /// min and max drop as their second argument.
  bool may_hit(const RTCRay& ray) const {
    return may_hit({ray.org_x, ray.org_y, ray.org_z}, {ray.dir_x, ray.dir_y, ray.dir_z}, ray.tnear, ray.tfar);
  }
  bool may_hit(Vec3 origin, Vec3 direction, float enter, float leave) const {
    const Vec3 inverse{1 / direction.x, 1 / direction.y, 1 / direction.z};
    for (int axis = 0; axis < 3; ++axis) {
      const float a = (bounds.lower[axis] - origin[axis]) * inverse[axis];
      const float b = (bounds.upper[axis] - origin[axis]) * inverse[axis];
      enter = std::max(enter, inverse[axis] < 0 ? b : a);
      leave = std::min(leave, inverse[axis] < 0 ? a : b);
    }
    return enter <= leave;
  }
};

/// The tree of a primitive that instances share, in its own space.
struct SharedTree {
  RTCScene scene = nullptr;
  Box3d bounds;
  float reach = 0;   ///< largest coordinate
};

/// What surface_point reads of a surface, found with one load each.
struct SurfaceArrays {
  const std::array<std::uint32_t, 3>* triangles;
  const Vec3 *positions, *normals;   ///< normals, uvs: null if there are none
  const Vec2* uvs;
  const Surface* instance;           ///< null if positions and normals are there
  std::uint32_t object, material;
  bool flipped, smooth;
  float instance_offset = 0;

  /// Positions or normals of a triangle's corners, in scene space: where they are (copies wait for their parts), those of
  /// an instance made in `own`.
  struct Corners {
    const Vec3 *a, *b, *c;
  };
  using Own = std::array<Vec3, 3>;
  Corners corner_positions(const std::array<std::uint32_t, 3>& corner, Own& own) const {
    if (instance) [[unlikely]] return instance_positions(corner, own);
    return {positions + corner[0], positions + corner[1], positions + corner[2]};
  }
  Corners corner_normals(const std::array<std::uint32_t, 3>& corner, Own& own) const {
    if (instance) [[unlikely]] return instance_normals(corner, own);
    return {normals + corner[0], normals + corner[1], normals + corner[2]};
  }
  [[gnu::noinline]] Corners instance_positions(const std::array<std::uint32_t, 3>& corner, Own& own) const {
    for (std::size_t i = 0; i < 3; ++i) own[i] = instance->position(corner[i]);
    return {&own[0], &own[1], &own[2]};
  }
  [[gnu::noinline]] Corners instance_normals(const std::array<std::uint32_t, 3>& corner, Own& own) const {
    for (std::size_t i = 0; i < 3; ++i) own[i] = instance->normal(corner[i]);
    return {&own[0], &own[1], &own[2]};
  }

  explicit SurfaceArrays(const Surface& s)
      : triangles(s.primitive->triangles.data()),
        positions(s.positions.data()),
        normals(s.normals.data()),
        uvs(s.primitive->uvs.empty() ? nullptr : s.primitive->uvs.data()),
        instance(s.instanced() ? &s : nullptr),
        object(s.object),
        material(s.material),
        flipped(s.flipped),
        smooth(s.smooth()) {}
};

constexpr unsigned kAllBlend = 1;   ///< RTCRay::id of a ray with all_blend

RTCRay to_embree(const Ray& ray) {
  RTCRay r;
  r.org_x = ray.origin.x; r.org_y = ray.origin.y; r.org_z = ray.origin.z; r.tnear = ray.t_min;
  r.dir_x = ray.direction.x; r.dir_y = ray.direction.y; r.dir_z = ray.direction.z; r.tfar = ray.t_max;
  r.time = 0; r.mask = 0xffffffffu; r.id = ray.all_blend ? kAllBlend : 0; r.flags = 0;
  return r;
}

/// What the filter of a surface that lets rays pass reads.
struct AlphaSurface {
  const SceneFrame* frame;
  std::uint32_t surface;
};

/// In [0, 1), from the bits of ray and triangle: the same ray meets the same triangle or passes it, in whatever
/// order Embree finds its hits, on any thread.
float chance(const RTCRay& ray, std::uint32_t surface, std::uint32_t triangle) {
  std::uint64_t key = mix64((std::uint64_t(surface) << 32 | triangle) + 0x616c706861ull);
  for (const float x : {ray.org_x, ray.org_y, ray.org_z, ray.dir_x, ray.dir_y, ray.dir_z})
    key = mix64(key ^ std::bit_cast<std::uint32_t>(x));
  return float(key >> 40) * 0x1p-24f;
}

/// Embree's filter of surfaces with alpha: refuses a hit where the surface is not there (MASK), or with probability
/// 1 - alpha (BLEND). Never throws: the texture was decoded before.
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

/// Eight rays as Embree takes them. Left out (valid 0) are those beyond the end of a list and unusable ones, whose
/// numbers must not come near Embree.
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

  /// Hits with this tree that are nearer than those found before; the rays are shortened to them. everywhere:
  /// the tree fills the scene, so that asking whether a ray may hit it would be a waste.
  void intersect(const Tree& tree, bool everywhere, bool alike, Hit* hits) {
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
    context.flags = alike ? RTC_INTERSECT_CONTEXT_FLAG_COHERENT : RTC_INTERSECT_CONTEXT_FLAG_INCOHERENT;
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

/// What all trees of a device come from.
struct Forest {
  RTCDevice device = rtcNewDevice(nullptr);
  std::unordered_map<const Primitive*, SharedTree> shared_trees;

  Forest() {
    if (!device) throw ResourceError("Embree: cannot make a device");
  }
  Forest(const Forest&) = delete;
  Forest& operator=(const Forest&) = delete;
  ~Forest() {
    for (const auto& [primitive, shared] : shared_trees)
      if (shared.scene) rtcReleaseScene(shared.scene);
    rtcReleaseDevice(device);
  }
};

struct StandingTree::Kept {
  std::shared_ptr<Forest> forest;
  Tree tree;
  std::vector<Surface> surfaces;   ///< those in it; they keep its arrays, so that equal addresses are equal arrays

  ~Kept() {
    if (tree.scene) rtcReleaseScene(tree.scene);
  }
  bool filtered = false;           ///< filters ask the frame they were made for: such a tree is of no other

  bool holds_for(const SceneFrame& frame) const {
    const auto same = [](const Surface& a, const Surface& b) {
      return a.primitive == b.primitive && a.positions.data() == b.positions.data() && a.scene_from_node == b.scene_from_node;
    };
    return !filtered && surfaces.size() == frame.static_count &&
           std::equal(surfaces.begin(), surfaces.end(), frame.surfaces.begin(), same) && !passable(frame);
  }
  static bool passable(const SceneFrame& frame) {
    return std::any_of(frame.surfaces.begin(), frame.surfaces.begin() + std::ptrdiff_t(frame.static_count),
                       [&](const Surface& s) { return lets_rays_pass(frame.materials[s.material]); });
  }
};

StandingTree::StandingTree() = default;
StandingTree::~StandingTree() = default;

struct Tracer::Impl {
  const SceneFrame* frame = nullptr;
  std::shared_ptr<Forest> forest;
  std::shared_ptr<const StandingTree::Kept> standing;   ///< owns `fixed`
  Tree fixed, moving;
  std::vector<SurfaceArrays> surfaces;
  std::deque<AlphaSurface> alpha;   ///< of the surfaces that have a filter; they stay where they are
  mutable std::atomic<std::uint64_t> refused{0};

  ~Impl() {
    if (moving.scene) rtcReleaseScene(moving.scene);
  }

  void throw_on_error() const {
    const RTCError error = rtcGetDeviceError(forest->device);
    if (error == RTC_ERROR_NONE) return;
    if (error == RTC_ERROR_OUT_OF_MEMORY) throw ResourceError("building the search tree: out of memory");
    throw ResourceError("building the search tree: Embree error " + std::to_string(int(error)));
  }

  RTCGeometry triangles_of(const Primitive& primitive, const Vec3* positions) {
    RTCGeometry geometry = rtcNewGeometry(forest->device, RTC_GEOMETRY_TYPE_TRIANGLE);
    // Embree reads vertices in 16-byte loads, so the last one needs padding: a copy of its own.
    auto* vertices = static_cast<Vec3*>(rtcSetNewGeometryBuffer(
        geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, sizeof(Vec3), primitive.positions.size()));
    if (vertices) std::copy_n(positions, primitive.positions.size(), vertices);
    rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, primitive.triangles.data(), 0,
                               sizeof primitive.triangles[0], primitive.triangles.size());
    return geometry;
  }

  const SharedTree& shared_tree(const Primitive& primitive) {
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

  void attach_instance(Tree& tree, const Surface& surface, unsigned id) {
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

  /// Rays meet an instance in its own space: what is rounded there counts in scene space by as much as the
  /// transform stretches, and where the instance stands is rounded as well.
  float instance_offset(const Surface& surface) const {
    const Affine& m = surface.scene_from_node;
    const double stretch = std::sqrt(std::max({length2(m.row[0]), length2(m.row[1]), length2(m.row[2])}));
    const double reach = double(forest->shared_trees.at(surface.primitive).reach);
    return kInstanceOffsetScale * float(max_component(abs(m.translation)) + 1.8 * stretch * reach);
  }

  SurfacePoint point_of(const Hit& hit) const;
  void build(Tree& tree, std::size_t first, std::size_t last) {
    tree.first_surface = std::uint32_t(first);
    if (first == last) return;
    tree.scene = rtcNewScene(forest->device);
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
        if (material.textures && material.textures->base_color)   // decoded here, not in the filter
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
};

Tracer::Tracer(const SceneFrame& frame) : impl_(std::make_unique<Impl>()) {
  StandingTree none;
  build(frame, none);
}

Tracer::Tracer(const SceneFrame& frame, StandingTree& standing) : impl_(std::make_unique<Impl>()) { build(frame, standing); }

void Tracer::build(const SceneFrame& frame, StandingTree& standing) {
  impl_->frame = &frame;
  if (!standing.kept_ || !standing.kept_->holds_for(frame)) {
    standing.kept_.reset();   // before the next one: they need not fit into memory together
    impl_->forest = std::make_shared<Forest>();
    const auto made = std::make_shared<StandingTree::Kept>();
    made->forest = impl_->forest;
    made->surfaces.assign(frame.surfaces.begin(), frame.surfaces.begin() + std::ptrdiff_t(frame.static_count));
    made->filtered = StandingTree::Kept::passable(frame);
    impl_->build(made->tree, 0, frame.static_count);
    standing.kept_ = made;
  }
  impl_->standing = standing.kept_;
  impl_->forest = impl_->standing->forest;
  impl_->fixed = impl_->standing->tree;
  impl_->build(impl_->moving, frame.static_count, frame.surfaces.size());
  for (const Surface& surface : frame.surfaces) {
    impl_->surfaces.emplace_back(surface);
    if (surface.instanced()) impl_->surfaces.back().instance_offset = impl_->instance_offset(surface);
  }
}

Tracer::~Tracer() = default;
Tracer::Tracer(Tracer&&) noexcept = default;

bool Tracer::intersect_static(const Ray& ray, Hit& hit) const {
  if (!impl_->fixed.exists()) return false;
  if (!usable(ray)) {
    impl_->refused.fetch_add(1, std::memory_order_relaxed);
    return false;
  }
  RTCRayHit query{to_embree(ray), {}};
  return intersect_tree(impl_->fixed, query, hit);
}

bool Tracer::intersect(const Ray& ray, Hit& hit) const {
  if (!usable(ray)) {
    impl_->refused.fetch_add(1, std::memory_order_relaxed);
    return false;
  }
  // The first call shortens the ray, so the second reports only what is strictly nearer.
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

void Tracer::intersect(std::span<const Ray> rays, std::span<Hit> hits, bool alike) const {
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
    if (impl_->fixed.exists()) packet.intersect(impl_->fixed, true, alike, found);
    if (impl_->moving.exists()) packet.intersect(impl_->moving, false, alike, found);
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

  // Kept in registers until stored once: a vector just stored and copied waits for its parts.
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
  point.offset = surface.instance ? surface.instance_offset
                                  : kOffsetScale * max_component(max(max(abs(a), abs(b)), abs(c)));
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

std::uint64_t Tracer::refused_ray_count() const { return impl_->refused.load(); }
const SceneFrame& Tracer::frame() const { return *impl_->frame; }

Ray spawn_shadow_ray(const SurfacePoint& point, Vec3 target, float target_offset) {
  const Vec3 origin = spawn_ray(point, target - point.position).origin;
  const Vec3 direction = target - origin;
  const float distance = length(direction);
  // Stop short of the light by its own offset, a few ulp of the distance at least.
  const float stop = distance > 0 ? 1 - std::min(0.5f, 4 * target_offset / distance + 0x1p-20f) : 0;
  return {origin, direction, 0, stop};
}

}  // namespace tempolux
