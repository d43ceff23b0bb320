// lib/scene/place_surfaces.h -- places the surfaces of nodes in scene space.
#pragma once

#include <string>
#include <unordered_map>
#include <vector>

#include "lib/scene/animate.h"
#include "lib/scene/at_frame.h"

namespace tempolux {

/// Limit of coordinates, m. The square of a distance must fit float32, and Embree has a similar limit.
inline constexpr float kMaxCoordinate = 1e15f;

/// "FILE: nodes[3] "Box"", for messages.
std::string node_place(const Scene& scene, std::size_t node);

/// Decides which primitives are instanced instead of copied. A primitive is instanced if it is rigid and opaque, never
/// emits, and occurs at least twice. It must also have at least 4096 triangles, or at least 256 if all copies together
/// would have 2^18. An occurrence is copied all the same if rounding in the instance's space would be visible: if the
/// condition number of its transform is above 30 (one axis is 21 times as long as the others), or if it is farther from
/// the world's origin than 256 times its size.
class Sharing {
 public:
  explicit Sharing(const Scene& scene);

  /// True if the primitive is instanced at an occurrence with this transform.
  bool instanced(const Primitive& primitive, const Affine& world_from_primitive) const;
  /// Box of an instanced primitive, in its own space.
  const Box3d& box(const Primitive& primitive) const { return box_.at(&primitive); }

 private:
  std::unordered_map<const Primitive*, Box3d> box_;  ///< of the primitives that are instanced
};

/// Moves all vertices to one place. No ray hits a surface without area, and it emits nothing.
void shrink(Surface& surface, Vec3 place);

/// World transforms of all occurrences of the node's mesh: one, unless EXT_mesh_gpu_instancing gives more.
std::vector<Affine> places(const Node& node, const Affine& world_from_node);

/// The nodes at a time.
struct NodesAtTime {
  double time_s = 0;
  const std::vector<Affine>& world_from_node;
};

/// Surfaces of the nodes that move in the segment, or of all other nodes, in node order. Nodes that the segment hides
/// have none; where another node is hidden at this time, its surfaces are shrunk to their first vertex. Throws
/// InputError if vertices lie outside kMaxCoordinate.
std::vector<Surface> place_surfaces(const Scene& scene, const Animator& animator, const Sharing& sharing,
                                    const Segment& segment, const NodesAtTime& nodes, bool moving);

}  // namespace tempolux
