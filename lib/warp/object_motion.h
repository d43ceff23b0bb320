// lib/warp/object_motion.h -- how each object of the scene is moved between two frames.
#pragma once

#include <cstdint>
#include <vector>

#include "lib/core/affine.h"
#include "lib/scene/at_frame.h"

namespace tempolux {

/// What happens to an object from one frame to another.
struct ObjectMotion {
  enum class Kind : std::uint8_t {
    still,      ///< its points stay where they are
    moved,      ///< by one affine transform
    deforming,  ///< each point by its own way (morph targets, skins, or a transform that cannot be undone)
    absent,     ///< not there in the other frame
  } kind = Kind::still;
  Affine other_from_here;  ///< world to world; the identity unless moved
};

/// Motions of all objects between two frames of one scene, by id.object. Objects are moved by their nodes; a shape that
/// deforms is `moved` (or still) between frames at which it has the same shape.
class ObjectMotions {
 public:
  /// Nothing moves.
  ObjectMotions() = default;
  ObjectMotions(const SceneFrame& here, const SceneFrame& other);

  /// An object that the scene does not have, and nothing (kNone), stand still.
  const ObjectMotion& of(std::uint32_t object) const { return object < motions_.size() ? motions_[object] : still_; }
  /// Objects from this number on are unknown.
  std::size_t count() const { return motions_.size(); }
  bool all_still() const { return all_still_; }

 private:
  std::vector<ObjectMotion> motions_;
  ObjectMotion still_;
  bool all_still_ = true;
};

}  // namespace tempolux
