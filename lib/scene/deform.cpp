// lib/scene/deform.cpp -- computes vertices of morphed and skinned meshes.
#include "lib/scene/deform.h"

#include <algorithm>

#include "lib/core/box_corners.h"

namespace tempolux {
namespace {

/// A vertex attribute with the weighted displacements of all morph targets.
Vec3d sum(const std::vector<Vec3>& rest, const std::vector<MorphTarget>& targets,
          std::vector<Vec3> MorphTarget::*displacements, const std::vector<double>& weights, std::size_t vertex) {
  Vec3d value(rest[vertex]);
  for (std::size_t t = 0; t < targets.size(); ++t)
    if (weights[t] != 0 && !(targets[t].*displacements).empty())
      value = value + Vec3d((targets[t].*displacements)[vertex]) * weights[t];
  return value;
}

/// world_from_mesh of a skinned vertex: the weighted sum over its joints.
Affine blended(const Primitive& primitive, const Pose& pose, std::size_t vertex) {
  const std::size_t n = primitive.influences_per_vertex;
  Affine m;
  m.row = {Vec3d{}, Vec3d{}, Vec3d{}};
  for (std::size_t i = vertex * n; i < (vertex + 1) * n; ++i) {
    const Influence& influence = primitive.influences[i];
    if (!(influence.weight > 0)) continue;
    const Affine& joint = pose.world_from_mesh[influence.joint];
    const double w = double(influence.weight);
    for (std::size_t r = 0; r < 3; ++r) m.row[r] = m.row[r] + joint.row[r] * w;
    m.translation = m.translation + joint.translation * w;
  }
  return m;
}

bool follows_joints(const Primitive& primitive, const Pose& pose) {
  return primitive.influences_per_vertex > 0 && !pose.world_from_mesh.empty();
}

}  // namespace

bool deforms(const Scene& scene, const Node& node) {
  if (node.mesh < 0) return false;
  return node.skin >= 0 || std::ranges::any_of(scene.meshes[std::size_t(node.mesh)].primitives,
                                               [](const Primitive& p) { return !p.targets.empty(); });
}

Shape deformed(const Primitive& primitive, const Pose& pose, const Affine& world_from_node, Vec3d origin) {
  Shape shape;
  const bool skinned = follows_joints(primitive, pose);
  bool smooth = !primitive.normals.empty();
  shape.positions.reserve(primitive.positions.size());
  double handedness = skinned ? 0 : world_from_node.determinant();
  for (std::size_t v = 0; v < primitive.positions.size(); ++v) {
    const Affine m = skinned ? blended(primitive, pose, v) : world_from_node;
    const Vec3d p = sum(primitive.positions, primitive.targets, &MorphTarget::positions, pose.weights, v);
    shape.positions.push_back(Vec3(m.point(p) - origin));
    if (skinned) handedness += m.determinant() < 0 ? -1 : 1;
    if (!smooth) continue;
    const Vec3d n =
        normalize(m.normal(sum(primitive.normals, primitive.targets, &MorphTarget::normals, pose.weights, v)));
    smooth = length2(n) > 0.5 && length2(n) < 2 && m.determinant() != 0;
    shape.normals.push_back(Vec3(n));
    if (primitive.tangents.empty()) continue;
    const Vec3d t = sum(primitive.tangents, primitive.targets, &MorphTarget::tangents, pose.weights, v);
    shape.tangents.push_back(Vec3(m.direction(t)));
  }
  if (!smooth) shape.normals.clear(), shape.tangents.clear();
  shape.flipped = handedness < 0;
  return shape;
}

PoseBounds::PoseBounds(const Scene& scene, const Node& node) {
  if (node.skin >= 0) by_joint_.resize(scene.skins[std::size_t(node.skin)].joints.size());
  for (const Primitive& primitive : scene.meshes[std::size_t(node.mesh)].primitives) {
    const std::size_t n = node.skin >= 0 ? primitive.influences_per_vertex : 0;
    for (std::size_t v = 0; v < primitive.positions.size(); ++v) {
      const Vec3d p(primitive.positions[v]);
      if (n == 0) rigid_.add(p);
      for (std::size_t i = v * n; i < (v + 1) * n; ++i)
        if (primitive.influences[i].weight > 0) by_joint_[primitive.influences[i].joint].add(p);
    }
    displacement_.resize(primitive.targets.size());
    for (std::size_t t = 0; t < primitive.targets.size(); ++t) {
      // Other primitives may have vertices without displacement.
      displacement_[t].add(Vec3d{});
      for (const Vec3& d : primitive.targets[t].positions) displacement_[t].add(Vec3d(d));
    }
  }
}

void PoseBounds::add_to(Box3d& bounds, const Pose& pose, const Affine& world_from_node) const {
  Vec3d lower{}, upper{};  // bounds of the displacement by morph targets over all vertices
  for (std::size_t t = 0; t < displacement_.size(); ++t) {
    const Vec3d a = displacement_[t].lower * pose.weights[t], b = displacement_[t].upper * pose.weights[t];
    lower = lower + min(a, b);
    upper = upper + max(a, b);
  }
  const auto add = [&](Box3d box, const Affine& m) {
    if (box.empty()) return;
    box.lower = box.lower + lower;
    box.upper = box.upper + upper;
    add_corners(bounds, box, m);
  };
  add(rigid_, world_from_node);
  for (std::size_t j = 0; j < by_joint_.size(); ++j) add(by_joint_[j], pose.world_from_mesh[j]);
}

}  // namespace tempolux
