// lib/trace/trees.h -- the data of a Tracer: Embree's trees, and surfaces laid out for look-ups. Shared by
// build_trees.cpp, trace.cpp (rays) and surface_points.cpp (hits).
#pragma once

#include <embree3/rtcore.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <deque>
#include <memory>
#include <unordered_map>
#include <vector>

#include "lib/scene/at_frame.h"
#include "lib/trace/trace.h"

namespace tempolux {

/// Distance between a ray's start and its surface, divided by the largest coordinate of the triangle: 16 ulp of
/// float32, four times the rounding of a point from barycentric coordinates and of Embree's arithmetic.
inline constexpr float kOffsetScale = 0x1p-20f;

struct Tree {
  RTCScene scene = nullptr;
  std::uint32_t first_surface = 0;
  Box3 bounds;  ///< slightly larger than its content

  bool exists() const { return scene != nullptr; }

  /// The surface of a hit: the geometry in this tree, or the instance in whose own tree the hit was found.
  std::uint32_t surface(std::uint32_t geometry, std::uint32_t instance) const {
    return first_surface + (instance == RTC_INVALID_GEOMETRY_ID ? geometry : instance);
  }

  /// False only if the ray misses the tree's box: a few operations instead of a walk through the tree. Distances are
  /// within 3 ulp, and the box exceeds its content by 2^-18. 0 x infinity (a ray in a face's plane) is NaN, which
  /// std::min and std::max ignore as second argument.
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

/// The tree of a primitive that several instances share, in the primitive's space.
struct SharedTree {
  RTCScene scene = nullptr;
  Box3d bounds;
  float reach = 0;  ///< largest coordinate
};

/// The arrays of a surface that surface_point reads, each found with one load.
struct SurfaceArrays {
  const std::array<std::uint32_t, 3>* triangles;
  const Vec3 *positions, *normals;  ///< normals and uvs are null if there are none
  const Vec2* uvs;
  const Surface* instance;  ///< the surface, if it is instanced and has no arrays; else null
  std::uint32_t object, material;
  bool flipped, smooth;
  float instance_offset = 0;

  /// Positions or normals of a triangle's corners in scene space. Pointers into the surface's arrays (copying would
  /// stall); for an instance they are computed into `own`.
  struct Corners {
    const Vec3 *a, *b, *c;
  };
  using Own = std::array<Vec3, 3>;
  Corners corner_positions(const std::array<std::uint32_t, 3>& corner, Own& own) const {
    if (instance) [[unlikely]]
      return instance_positions(corner, own);
    return {positions + corner[0], positions + corner[1], positions + corner[2]};
  }
  Corners corner_normals(const std::array<std::uint32_t, 3>& corner, Own& own) const {
    if (instance) [[unlikely]]
      return instance_normals(corner, own);
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

inline constexpr unsigned kAllBlend = 1;  ///< RTCRay::id of a ray with all_blend

/// The data that the filter of a surface with alpha reads.
struct AlphaSurface {
  const SceneFrame* frame;
  std::uint32_t surface;
};

/// The Embree device of all trees. The instruction set is fixed: wider instructions of some processors round hits
/// differently and do not make single rays faster. The set is the one this program is compiled for.
struct Forest {
  RTCDevice device = rtcNewDevice("isa=avx2");
  std::unordered_map<const Primitive*, SharedTree> shared_trees;

  Forest();
  Forest(const Forest&) = delete;
  Forest& operator=(const Forest&) = delete;
  ~Forest();
};

struct StaticTree::Kept {
  std::shared_ptr<Forest> forest;
  Tree tree;
  /// The surfaces in the tree; holding their arrays ensures that equal addresses mean equal arrays.
  std::vector<Surface> surfaces;
  /// True if the tree has intersection filters, which point to this frame: the tree must not be reused for another
  /// frame.
  bool filtered = false;

  ~Kept() {
    if (tree.scene) rtcReleaseScene(tree.scene);
  }
  bool holds_for(const SceneFrame& frame) const;
  static bool passable(const SceneFrame& frame);
};

struct Tracer::Impl {
  const SceneFrame* frame = nullptr;
  std::shared_ptr<Forest> forest;
  std::shared_ptr<const StaticTree::Kept> static_scene;  ///< owns `fixed`
  Tree fixed, moving;
  std::vector<SurfaceArrays> surfaces;
  std::deque<AlphaSurface> alpha;  ///< data of the filters; a deque, since filters point to its elements
  bool panes = false;
  mutable std::atomic<std::uint64_t> refused{0};

  ~Impl() {
    if (moving.scene) rtcReleaseScene(moving.scene);
  }

  void build(Tree& tree, std::size_t first, std::size_t last);
  /// m: distance from an instance at which rays that leave the instance start, so that they do not hit it again by
  /// rounding. Embree intersects an instance in the instance's own space. The transform to scene space scales the
  /// rounding errors of this space, and its translation is rounded, too.
  float instance_offset(const Surface& surface) const;
  SurfacePoint point_of(const Hit& hit) const;

 private:
  void throw_on_error() const;
  RTCGeometry triangles_of(const Primitive& primitive, const Vec3* positions);
  const SharedTree& shared_tree(const Primitive& primitive);
  void attach_instance(Tree& tree, const Surface& surface, unsigned id);
};

}  // namespace tempolux
