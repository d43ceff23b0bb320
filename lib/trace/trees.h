// lib/trace/trees.h -- the data of a Tracer: Embree's trees, and surfaces laid out for look-ups. Shared by trace.cpp
// (trees and rays) and surface_points.cpp (hits).
#pragma once

#include <algorithm>
#include <array>
#include <atomic>
#include <memory>
#include <unordered_map>
#include <vector>

#include "lib/scene/at_frame.h"
#include "lib/trace/plates.h"
#include "lib/trace/trace.h"

// Embree's handles; trace.cpp alone includes Embree.
typedef struct RTCDeviceTy* RTCDevice;
typedef struct RTCSceneTy* RTCScene;
typedef struct RTCGeometryTy* RTCGeometry;

namespace tempolux {

/// Distance between a ray's start and its surface, as a share of the triangle's largest coordinate: 16 ulp of float32,
/// which is four times the rounding of a point from barycentric coordinates and in Embree's arithmetic.
inline constexpr float kOffsetScale = 0x1p-20f;

/// A search tree over surfaces of the frame, in scene space.
struct Tree {
  RTCScene scene = nullptr;
  std::uint32_t first_surface = 0;
  Box3 bounds;  ///< of its content
  /// The corners of a box that is larger than its content by 2^-18 of the largest coordinate.
  alignas(16) float lower[4] = {}, upper[4] = {};

  bool exists() const { return scene != nullptr; }
};

/// The tree of a primitive that several instances share, in the primitive's space.
struct SharedTree {
  RTCScene scene = nullptr;
  Box3d bounds;
  float reach = 0;  ///< largest coordinate
};

/// The data of a surface that Tracer::surface_point() reads.
struct SurfaceArrays {
  const std::array<std::uint32_t, 3>* triangles;
  const Vec3 *positions, *normals;  ///< normals and uvs are null if there are none
  const Vec2* uvs;
  const Surface* instance;  ///< the surface, if it is instanced and has no arrays; else null
  std::uint32_t object, material;
  bool flipped, smooth, passable = false;  ///< passable: lets_rays_pass()
  float instance_offset = 0;
  const float* plates = nullptr;  ///< SurfacePoint::plate of each triangle; null: no triangle bounds a plate

  /// Positions or normals of a triangle's corners in scene space: pointers into the surface's arrays, since copying
  /// would stall, or into `own`, to which the vertices of an instance are written.
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

/// The Embree device of all trees, and the trees that instances share.
struct Forest {
  RTCDevice device;
  std::unordered_map<const Primitive*, SharedTree> shared_trees;

  Forest();
  Forest(const Forest&) = delete;
  Forest& operator=(const Forest&) = delete;
  ~Forest();
};

/// Plates of the static surfaces.
struct StaticTree::Plates {
  std::vector<std::uint32_t> searched;  ///< surfaces that may have plates, by their material
  PlatesOfSurfaces found;
};

struct StaticTree::Kept {
  std::shared_ptr<Forest> forest;
  Tree tree;
  /// The surfaces in the tree. Their arrays are kept, so an array of a later frame has the same address only if it is
  /// the same array.
  std::vector<Surface> surfaces;

  ~Kept();
  bool holds_for(const SceneFrame& frame) const;  ///< true if the frame's Tracer can use this tree
};

struct Tracer::Impl {
  const SceneFrame* frame = nullptr;
  std::shared_ptr<Forest> forest;
  std::shared_ptr<const StaticTree::Kept> static_scene;  ///< owns `fixed`
  Tree fixed, moving;
  std::vector<SurfaceArrays> surfaces;
  std::shared_ptr<const StaticTree::Plates> static_plates;
  PlatesOfSurfaces moving_plates;
  bool panes = false;
  mutable std::atomic<std::uint64_t> refused{0};

  ~Impl();

  void build(Tree& tree, std::size_t first, std::size_t last);
  /// SurfacePoint::offset of an instance [m]. Embree intersects an instance in the instance's own space; the transform
  /// to scene space scales the rounding errors of that space, and its translation is rounded, too.
  float instance_offset(const Surface& surface) const;
  SurfacePoint point_of(const Hit& hit) const;
  void add_surfaces(std::size_t first, std::size_t last);
  void use_plates(const PlatesOfSurfaces& plates);
  struct Query;
  struct NearestQuery;
  struct AnyQuery;

 private:
  void throw_on_error() const;
  RTCGeometry triangles_of(const Primitive& primitive, const Vec3* positions);
  const SharedTree& shared_tree(const Primitive& primitive);
  void attach_instance(Tree& tree, const Surface& surface, unsigned id);
};

}  // namespace tempolux
