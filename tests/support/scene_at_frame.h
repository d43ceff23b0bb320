// tests/support/scene_at_frame.h -- a scene at one frame, for tests that need no other.
#pragma once

#include "lib/scene/at_frame.h"

namespace tempolux {

inline SceneFrame scene_at_frame(const Scene& scene, const Segment& segment, int frame, const TimeOptions& options) {
  return SegmentScene(scene, segment, options).at(frame);
}

}  // namespace tempolux
