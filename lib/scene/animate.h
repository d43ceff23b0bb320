// lib/scene/animate.h -- local and world transforms of nodes at a time.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "lib/scene/scene.h"

namespace tempolux {

/// Value of a track at a time [s] into `out`, which has room for its components. Before the first and after the
/// last key it holds that key's value; LINEAR rotations turn along the shorter arc at constant speed (slerp),
/// splines of rotations are made unit. A time that equals a key's when both are rounded to float32, as files
/// store them, gives exactly that key; equal neighbouring keys give exactly their value in between.
/// glTF 2.0, 3.11 and appendix C.
void evaluate(const AnimationTrack& track, double time_s, std::span<double> out);
/// The same of a track of up to four components: xyz, or a unit quaternion xyzw; the others are 0.
std::array<double, 4> evaluate(const AnimationTrack& track, double time_s);

/// The shape of a node's mesh: two equal poses have equal vertices.
struct Pose {
  std::vector<double> weights;          ///< by morph target; empty: none
  std::vector<Affine> world_from_mesh;  ///< by joint of the node's skin (identity where no vertex follows
                                        ///< it); empty: no skin
  bool operator==(const Pose&) const = default;
};

/// The tracks of a scene by what they change, so that evaluating many frames looks nothing up twice.
class Animator {
 public:
  explicit Animator(const Scene& scene);

  /// World transform of every node at a time [s].
  std::vector<Affine> world_from_node(double time_s) const;
  /// Morph weights and joints of a node at a time, given its world transforms. Empty for a rigid mesh.
  Pose pose(std::size_t node, double time_s, const std::vector<Affine>& world_from_node) const;
  /// Something in the scene has a track.
  bool anything_animated() const { return anything_animated_; }
  /// The tracks of one node.
  const std::vector<const AnimationTrack*>& tracks(std::size_t node) const { return tracks_[node]; }
  /// The tracks of materials, lights and cameras.
  const std::vector<const AnimationTrack*>& property_tracks() const { return property_tracks_; }

  /// Materials, a light, a camera at a time: what no track changes is as in the scene; what a spline takes out
  /// of its range is brought back into it.
  std::vector<Material> materials(double time_s) const;
  PunctualLight light(std::size_t index, double time_s) const;
  Camera camera(std::size_t index, double time_s) const;

 private:
  Affine local(std::size_t node, double time_s) const;

  const Scene* scene_;
  std::vector<std::vector<const AnimationTrack*>> tracks_;
  std::vector<const AnimationTrack*> property_tracks_;
  std::vector<std::vector<std::uint8_t>> joint_used_;  ///< per node with a skin: by joint
  bool anything_animated_ = false;
};

/// What a track changes: "node", "material", "light" or "camera".
const char* kind_of(AnimationTrack::Path path);

}  // namespace tempolux
