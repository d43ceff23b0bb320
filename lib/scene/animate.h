// lib/scene/animate.h -- local and world transforms of nodes at a time.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "lib/scene/scene.h"

namespace tempolux {

/// Writes the value of a track at a time [s] to `out`, which has room for its components. Before the first key and
/// after the last one the value is that key's. LINEAR rotations turn along the shorter arc at constant speed (slerp);
/// splines of rotations are normalised. If a time equals a key's time after both are rounded to float32, as files store
/// them, the value is exactly the key's; between equal keys it is exactly their value. glTF 2.0, 3.11 and appendix C.
void evaluate(const AnimationTrack& track, double time_s, std::span<double> out);
/// The same for a track of up to four components: xyz, or a unit quaternion xyzw. Missing components are 0.
std::array<double, 4> evaluate(const AnimationTrack& track, double time_s);

/// The shape of a node's mesh: two equal poses have equal vertices.
struct Pose {
  std::vector<double> weights;  ///< by morph target; empty: none
  /// One transform per joint of the node's skin; the identity for a joint that no vertex follows. Empty: no skin.
  std::vector<Affine> world_from_mesh;
  bool operator==(const Pose&) const = default;
};

/// The tracks of a scene sorted by target, so that evaluating many frames needs no search.
class Animator {
 public:
  explicit Animator(const Scene& scene);

  /// World transform of every node at a time [s].
  std::vector<Affine> world_from_node(double time_s) const;
  /// Morph weights and joints of a node's mesh at a time, from the nodes' world transforms. Empty for a rigid mesh.
  Pose pose(std::size_t node, double time_s, const std::vector<Affine>& world_from_node) const;
  /// True if the scene has any track.
  bool anything_animated() const { return anything_animated_; }
  /// The tracks of one node.
  const std::vector<const AnimationTrack*>& tracks(std::size_t node) const { return tracks_[node]; }
  /// The tracks of materials, lights and cameras.
  const std::vector<const AnimationTrack*>& property_tracks() const { return property_tracks_; }

  /// Materials, a light or a camera at a time. Properties without a track are as in the scene; values that a spline
  /// takes out of their range are clamped.
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

/// Kind of the track's target: "node", "material", "light" or "camera".
const char* kind_of(AnimationTrack::Path path);

}  // namespace tempolux
