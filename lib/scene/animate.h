// lib/scene/animate.h -- local and world transforms of nodes at a time.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "lib/scene/scene.h"

namespace tempolux {

/// Writes the value of a track at a time [s] to `out`, which has room for the track's components. Before the first key
/// the value is the first key's, after the last key the last key's. LINEAR rotations turn along the shorter arc at
/// constant speed (slerp); splines of rotations are normalised. Files store times as float32: if a time equals a key's
/// after both are rounded to float32, the value is exactly the key's. Between two keys with equal values the result is
/// exactly this value; in a spline the tangents must be zero, too. Source: glTF 2.0, 3.11 and appendix C.
void evaluate(const AnimationTrack& track, double time_s, std::span<double> out);
/// The value of a track of up to four components: xyz, or a unit quaternion xyzw. Missing components are 0.
std::array<double, 4> evaluate(const AnimationTrack& track, double time_s);

/// The shape of a node's mesh: two equal poses have equal vertices.
struct Pose {
  std::vector<double> weights;  ///< by morph target; empty: none
  /// One transform per joint of the node's skin; the identity for a joint that no vertex follows. Empty: no skin.
  std::vector<Affine> world_from_mesh;
  bool operator==(const Pose&) const = default;
};

/// The tracks of a scene sorted by target, so that evaluating many frames needs no search. The scene must outlive it.
class Animator {
 public:
  /// Takes time in proportion to the scene's tracks and joints.
  explicit Animator(const Scene& scene);

  /// World transform of every node at a time [s].
  std::vector<Affine> world_from_node(double time_s) const;
  /// Morph weights and joints of a node's mesh at a time [s]; `world_from_node` is that of the same time. Empty for a
  /// rigid mesh.
  Pose pose(std::size_t node, double time_s, const std::vector<Affine>& world_from_node) const;
  /// For each node, 1 if it and all its ancestors are visible at a time [s] (KHR_node_visibility).
  std::vector<std::uint8_t> seen(double time_s) const;
  /// True if the scene has any track.
  bool anything_animated() const { return anything_animated_; }
  /// The tracks of one node.
  const std::vector<const AnimationTrack*>& tracks(std::size_t node) const { return tracks_[node]; }
  /// The tracks of materials, lights and cameras.
  const std::vector<const AnimationTrack*>& property_tracks() const { return property_tracks_; }

  /// All materials, or the light or camera of an index, at a time [s]. Properties without a track are as in the scene.
  /// A value that a spline takes out of its range is clamped. Throws InputError if colour times strength overflows
  /// float32.
  std::vector<Material> materials(double time_s) const;
  PunctualLight light(std::size_t index, double time_s) const;
  Camera camera(std::size_t index, double time_s) const;

 private:
  Affine local(std::size_t node, double time_s) const;

  const Scene* scene_;
  std::vector<std::vector<const AnimationTrack*>> tracks_;
  std::vector<const AnimationTrack*> property_tracks_;
  /// For each node with a skin and each joint of the skin: 1 if a vertex of the mesh follows the joint.
  std::vector<std::vector<std::uint8_t>> joint_used_;
  bool anything_animated_ = false;
  bool anything_hides_ = false;  ///< true if some node is not visible at rest or has a track of its visibility
};

/// Kind of the track's target: "node", "material", "light" or "camera".
const char* kind_of(AnimationTrack::Path path);

}  // namespace tempolux
