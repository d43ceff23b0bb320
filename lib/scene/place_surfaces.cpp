// lib/scene/place_surfaces.cpp -- places the surfaces of nodes in scene space.
#include "lib/scene/place_surfaces.h"

#include <algorithm>

#include "formats/error.h"
#include "lib/core/box_corners.h"
#include "lib/scene/deform.h"
#include "lib/scene/material_properties.h"

namespace tempolux {
namespace {

/// In each process a copy costs, per triangle, 36 bytes, about 100 bytes of search tree, and .35 us for building the
/// tree. An instance costs about 1 kB, and a transform for every ray that enters its box: up to 8 % of a frame. So a
/// primitive of few triangles is instanced only if building trees for its copies would take a tenth of a second.
constexpr std::size_t kFewestTriangles = 4096, kFewestOfSmall = 256, kFewestCopied = 1 << 18;

bool is_worth_sharing(std::size_t triangles, std::size_t uses) {
  return uses >= 2 &&
         (triangles >= kFewestTriangles || (triangles >= kFewestOfSmall && uses * triangles >= kFewestCopied));
}

/// Largest condition number of an instance's transform: the norm of the matrix times the norm of its inverse, 3 for a
/// rotation. The rounding error of a ray in the instance's space is a few ulp times this number.
constexpr double kLargestCondition = 30;

double norm(const Affine& m) { return std::sqrt(length2(m.row[0]) + length2(m.row[1]) + length2(m.row[2])); }

bool well_conditioned(const Affine& m) {
  return m.determinant() != 0 && norm(m) * norm(inverse(m)) <= kLargestCondition;
}

/// Farther from the origin than this many times its size, an instance would show the rounding of its coordinates.
constexpr double kFarthest = 256;

bool near_enough(const Box3d& box, const Affine& m) {
  const double stretch = std::sqrt(std::min({length2(m.row[0]), length2(m.row[1]), length2(m.row[2])}));
  return length(m.translation) + norm(m) * length(box.centre()) <= kFarthest * stretch * box.diagonal();
}

bool may_emit(const Scene& scene, std::uint32_t material) {
  if (scene.materials[material].emissive()) return true;
  for (const Animation& animation : scene.animations)
    for (const AnimationTrack& track : animation.tracks)
      if (changes_emission(track) && std::uint32_t(track.target) == material) return true;
  return false;
}

/// Transforms each point in double precision, then rounds once.
std::vector<Vec3> place_points(const std::vector<Vec3>& points, const Affine& scene_from_node) {
  std::vector<Vec3> placed;
  placed.reserve(points.size());
  for (const Vec3& p : points) placed.push_back(Vec3(scene_from_node.point(Vec3d(p))));
  return placed;
}

/// Transformed unit normals. Empty, which means flat shading, if there are none or the transform leaves one without a
/// direction.
std::vector<Vec3> place_normals(const std::vector<Vec3>& normals, const Affine& scene_from_node) {
  std::vector<Vec3> placed;
  if (scene_from_node.determinant() == 0) return placed;
  placed.reserve(normals.size());
  for (const Vec3& n : normals) {
    const Vec3d unit = normalize(scene_from_node.normal(Vec3d(n)));
    if (!(length2(unit) > 0.5 && length2(unit) < 2)) return {};
    placed.push_back(Vec3(unit));
  }
  return placed;
}

void check_range(const Scene& scene, std::size_t n, const Surface& surface, const Sharing& sharing) {
  Box3 box;
  for (const Vec3& p : surface.positions) box.add(p);
  if (surface.instanced())
    for_corners(surface.scene_from_node, sharing.box(*surface.primitive), [&](Vec3d corner) { box.add(Vec3(corner)); });
  for (const Vec3& corner : {box.lower, box.upper})
    if (!(max_component(abs(corner)) < kMaxCoordinate))
      throw InputError(node_place(scene, n) + ": its transform takes vertices beyond 1e15 m");
}

}  // namespace

std::string node_place(const Scene& scene, std::size_t n) {
  const Node& node = scene.nodes[n];
  return scene.path + ": nodes[" + std::to_string(node.source_index) + "]" +
         (node.name.empty() ? "" : " \"" + node.name + "\"");
}

Sharing::Sharing(const Scene& scene) {
  std::vector<std::size_t> uses(scene.meshes.size(), 0);
  for (const Node& node : scene.nodes)
    if (node.mesh >= 0 && !deforms(scene, node))
      uses[std::size_t(node.mesh)] += std::max<std::size_t>(node.instances.size(), 1);
  for (std::size_t m = 0; m < uses.size(); ++m) {
    for (const Primitive& primitive : scene.meshes[m].primitives) {
      if (!is_worth_sharing(primitive.triangles.size(), uses[m]) || may_emit(scene, primitive.material)) continue;
      // Rays test alpha, for which a surface must be a copy.
      if (scene.materials[primitive.material].alpha_mode != Material::Alpha::opaque) continue;
      Box3d& box = box_[&primitive];
      for (const Vec3& p : primitive.positions) box.add(Vec3d(p));
    }
  }
}

bool Sharing::instanced(const Primitive& primitive, const Affine& world_from_primitive) const {
  const auto found = box_.find(&primitive);
  return found != box_.end() && well_conditioned(world_from_primitive) &&
         near_enough(found->second, world_from_primitive);
}

void shrink(Surface& surface, Vec3 place) {
  surface.positions = std::vector<Vec3>(surface.primitive->positions.size(), place);
  surface.normals = {};
  surface.tangents = {};
}

std::vector<Affine> places(const Node& node, const Affine& world_from_node) {
  if (node.instances.empty()) return {world_from_node};
  std::vector<Affine> places;
  places.reserve(node.instances.size());
  for (const Affine& node_from_instance : node.instances) places.push_back(world_from_node * node_from_instance);
  return places;
}

std::vector<Surface> place_surfaces(const Scene& scene, const Animator& animator, const Sharing& sharing,
                                    const Segment& segment, const NodesAtTime& nodes, bool moving) {
  std::vector<Surface> surfaces;
  const std::vector<std::uint8_t> seen = animator.seen(nodes.time_s);
  for (std::size_t n = 0; n < scene.nodes.size(); ++n) {
    const Node& node = scene.nodes[n];
    if (node.mesh < 0 || segment.hides(std::uint32_t(n)) || (segment.node_moves[n] != 0) != moving) continue;
    const bool deforming = deforms(scene, node);
    const Pose pose = deforming ? animator.pose(n, nodes.time_s, nodes.world_from_node) : Pose{};
    for (const Affine& place : places(node, nodes.world_from_node[n])) {
      Affine scene_from_node = place;
      scene_from_node.translation = scene_from_node.translation - segment.origin;
      for (const Primitive& primitive : scene.meshes[std::size_t(node.mesh)].primitives) {
        Surface surface;
        surface.object = node.object;
        surface.node = std::uint32_t(n);
        surface.material = primitive.material;
        surface.flipped = scene_from_node.determinant() < 0;
        surface.primitive = &primitive;
        surface.scene_from_node = scene_from_node;
        if (deforming) {
          Shape shape = deformed(primitive, pose, place, segment.origin);
          surface.flipped = shape.flipped;
          surface.positions = std::move(shape.positions);
          surface.normals = std::move(shape.normals);
          surface.tangents = std::move(shape.tangents);
        } else if (!sharing.instanced(primitive, place)) {
          surface.positions = place_points(primitive.positions, scene_from_node);
          surface.normals = place_normals(primitive.normals, scene_from_node);
        }
        if (!seen[n]) shrink(surface, surface.position(0));
        check_range(scene, n, surface, sharing);
        surfaces.push_back(std::move(surface));
      }
    }
  }
  return surfaces;
}

}  // namespace tempolux
