// lib/scene/moving_objects.h -- lists the objects that move in the segment.
#pragma once

#include <cstdint>
#include <utility>
#include <vector>

#include "lib/scene/at_frame.h"

namespace tempolux {

/// The objects (id.object) that have a moving surface in the segment.
class MovingObjects {
 public:
  explicit MovingObjects(std::vector<bool> moves = {}) : moves_(std::move(moves)) {}
  explicit MovingObjects(const SceneFrame& frame) {
    for (std::size_t s = frame.static_count; s < frame.surfaces.size(); ++s) {
      const std::size_t object = frame.surfaces[s].object;
      if (object >= moves_.size()) moves_.resize(object + 1);
      moves_[object] = true;
    }
  }
  bool contains(std::uint32_t object) const { return object < moves_.size() && moves_[object]; }

 private:
  std::vector<bool> moves_;  ///< by object
};

}  // namespace tempolux
