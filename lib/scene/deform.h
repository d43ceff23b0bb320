// lib/scene/deform.h -- vertices of morphed and skinned meshes in a pose.
#pragma once

#include <vector>

#include "lib/scene/animate.h"

namespace tempolux {

/// True if the shape of the node's mesh changes over time, by morph targets or by a skin.
bool deforms(const Scene& scene, const Node& node);

/// The vertices of a primitive in a pose.
struct Shape {
  std::vector<Vec3> positions;  ///< scene space, m; computed in double, rounded once
  std::vector<Vec3> normals;    ///< unit; empty: flat shading
  std::vector<Vec3> tangents;   ///< not unit; empty: the primitive has none, or flat shading
  bool flipped = false;         ///< the transform mirrors
};

/// The vertices of a primitive in a pose, moved by -origin (world space). Morph targets come first: p + sum of weight x
/// displacement; normals likewise. Then a matrix M takes the vertex to world space: the sum of weight x world_from_mesh
/// of the joints that the vertex follows, or world_from_node if the pose or the primitive has no joints. Normals use
/// the inverse transpose of M, tangents M without its translation. Source: glTF 2.0, 3.7.2.2 and 3.7.3. If any vertex
/// has no normal in the pose, because M is flat there or normals cancel, all normals are dropped: flat shading.
Shape deformed(const Primitive& primitive, const Pose& pose, const Affine& world_from_node, Vec3d origin);

/// Boxes that bound a mesh in any pose without visiting its vertices again. A skinned vertex lies in the hull of the
/// places where each of its joints alone would move it.
class PoseBounds {
 public:
  PoseBounds(const Scene& scene, const Node& node);
  /// Adds a box (world space) that holds all vertices in the pose.
  void add_to(Box3d& bounds, const Pose& pose, const Affine& world_from_node) const;

 private:
  Box3d rigid_;                      ///< vertices that no joint moves
  std::vector<Box3d> by_joint_;      ///< vertices that follow each joint
  std::vector<Box3d> displacement_;  ///< displacements by each morph target
};

}  // namespace tempolux
