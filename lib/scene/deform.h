// lib/scene/deform.h -- vertices of morphed and skinned meshes in a pose.
#pragma once

#include <vector>

#include "lib/scene/animate.h"

namespace tempolux {

/// Whether the node's mesh has a shape of its own at each time: morph targets or a skin that moves it.
bool deforms(const Scene& scene, const Node& node);

struct Shape {
  std::vector<Vec3> positions;  ///< scene space, m; computed in double, rounded once
  std::vector<Vec3> normals;    ///< unit; empty: flat shading
  std::vector<Vec3> tangents;   ///< not unit; empty: the primitive has none, or flat shading
  bool flipped = false;         ///< the transform mirrors
};

/// The vertices of a primitive in a pose. Morph targets first: p + sum of weight x displacement, normals alike.
/// Then, if the pose has joints and the primitive follows them, M p with M = sum of weight x world_from_mesh of
/// the joints, normals by the inverse transpose of M, tangents by M without its translation; else world_from_node. glTF
/// 2.0, 3.7.2.2 and 3.7.3.
///
/// Normals are dropped (flat shading) where a vertex has none in the pose: M is flat there, or they cancel.
Shape deformed(const Primitive& primitive, const Pose& pose, const Affine& world_from_node, Vec3d origin);

/// Boxes from which the bounds of a mesh in any pose follow without visiting its vertices again: a skinned
/// vertex lies in the hull of where its joints alone would put it.
class PoseBounds {
 public:
  PoseBounds(const Scene& scene, const Node& node);
  /// Adds a box, world space, that holds all vertices in the pose.
  void add_to(Box3d& bounds, const Pose& pose, const Affine& world_from_node) const;

 private:
  Box3d rigid_;                      ///< vertices that no joint moves
  std::vector<Box3d> by_joint_;      ///< vertices that follow a joint
  std::vector<Box3d> displacement_;  ///< by morph target
};

}  // namespace tempolux
