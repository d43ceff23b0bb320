// lib/warp/object_motion.h -- finds how each object of the scene moves between two frames.
#pragma once

#include <cstdint>
#include <vector>

#include "lib/core/affine.h"
#include "lib/scene/at_frame.h"

namespace tempolux {

/// The motion of an object from one frame to another.
struct ObjectMotion {
  enum class Kind : std::uint8_t {
    still,      ///< its points stay where they are
    moved,      ///< moved by one affine transform
    deforming,  ///< each point moves separately (morph targets, skins, or a transform that is not invertible)
    absent,     ///< the object does not exist in the other frame
  } kind = Kind::still;
  Affine other_from_here;  ///< world to world; the identity unless `moved`
};

/// Motions of all objects between two frames of one scene, by id.object. Objects move with their nodes. A deforming
/// shape counts as `moved` or `still` between two frames at which it has the same shape.
class ObjectMotions {
 public:
  /// No object moves.
  ObjectMotions() = default;
  ObjectMotions(const SceneFrame& here, const SceneFrame& other);

  /// Motion of an object. An object that the scene does not have, and kNone, is still.
  const ObjectMotion& of(std::uint32_t object) const { return object < motions_.size() ? motions_[object] : still_; }
  /// Number of known objects.
  std::size_t count() const { return motions_.size(); }
  bool all_still() const { return all_still_; }
  /// For each object, the transform from a space of this frame (such as camera space) to a space of the other frame:
  /// `space_from_other` x the object's motion x `here_from_space`. Objects that do not move get `still`.
  std::vector<Affine> transforms(const Affine& space_from_other, const Affine& here_from_space,
                                 const Affine& still) const;

 private:
  std::vector<ObjectMotion> motions_;
  ObjectMotion still_;
  bool all_still_ = true;
};

}  // namespace tempolux
