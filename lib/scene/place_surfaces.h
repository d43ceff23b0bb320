// lib/scene/place_surfaces.h -- the surfaces of nodes in scene space.
#pragma once

#include <string>
#include <unordered_map>
#include <vector>

#include "lib/scene/animate.h"
#include "lib/scene/at_frame.h"

namespace tempolux {

/// Beyond this [m] squares of distances leave float32 and Embree's own limits come near.
inline constexpr float kMaxCoordinate = 1e15f;

/// "FILE: nodes[3] "Box"", for messages.
std::string node_place(const Scene& scene, std::size_t node);

/// Which primitives stand in the scene so often that their surfaces are better instances than copies: those of 4096
/// triangles or more that stand twice or more, rigid, opaque and dark at all times. Each where it stands is an instance
/// if its transform's norm times that of its inverse is at most 30 (one axis up to 21 times the others) and it is
/// within 256 times its size of the world's origin: elsewhere rounding in the instance's space would show, and it is a
/// copy.
class Sharing {
 public:
  explicit Sharing(const Scene& scene);

  /// Whether the primitive is to be instanced where it stands with this transform.
  bool instanced(const Primitive& primitive, const Affine& world_from_primitive) const;
  /// Box of a shared primitive, its own space.
  const Box3d& box(const Primitive& primitive) const { return box_.at(&primitive); }

 private:
  std::unordered_map<const Primitive*, Box3d> box_;  ///< of the primitives that are shared
};

/// World transform of each place where the node's mesh stands: one but for EXT_mesh_gpu_instancing.
std::vector<Affine> places(const Node& node, const Affine& world_from_node);

/// Surfaces of the nodes that move in the segment, or of those that do not, in node order, at a time [s] with the
/// nodes' world transforms. Throws InputError if vertices come to lie beyond kMaxCoordinate.
std::vector<Surface> place_surfaces(const Scene& scene, const Animator& animator, const Sharing& sharing,
                                    const Segment& segment, double time_s, const std::vector<Affine>& world_from_node,
                                    bool moving);

}  // namespace tempolux
