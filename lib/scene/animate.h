// lib/scene/animate.h -- local and world transforms of nodes at a time.
#pragma once

#include <array>
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

/// The tracks of a scene by node, so that evaluating many frames looks nothing up twice.
class Animator {
 public:
  explicit Animator(const Scene& scene);

  /// World transform of every node at a time [s].
  std::vector<Affine> world_from_node(double time_s) const;
  /// Per node: a track of it or of an ancestor has two keys that differ.
  const std::vector<bool>& animated() const { return animated_; }
  /// The tracks of one node.
  const std::vector<const AnimationTrack*>& tracks(std::size_t node) const { return tracks_[node]; }

 private:
  Affine local(std::size_t node, double time_s) const;

  const Scene* scene_;
  std::vector<std::vector<const AnimationTrack*>> tracks_;
  std::vector<bool> animated_;
};

}  // namespace tempolux
