// lib/plan/decide.h -- decides what a segment needs, from pilots of frames that the segment fixes
// (formats/plan/plan.md).
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "lib/light/lights.h"
#include "lib/plan/decisions.h"
#include "lib/plan/plan.h"
#include "lib/scene/at_frame.h"
#include "lib/trace/trace.h"

namespace tempolux {

/// Gives the pilots access to the scene.
struct SceneSource {
  /// The scene at a frame inside the animation; without media if `with_media` is false.
  std::function<SceneFrame(int frame, bool with_media)> at;
  std::function<EmissionTable(int frame)> emission;  ///< the emission table of the frame's segment
  int camera_node = 0;
};

/// Frames of a segment for which pilots run: the first, the middle and the last one, and up to four at which
/// something begins to move or comes to rest. A frame that shows the same picture as an earlier one is left out.
/// Ascending.
std::vector<int> looked_frames(const PlannedSegment& segment);

/// Makes the decisions of one segment. Each looked frame has its own pilot. The number of light paths is the largest
/// that a looked frame needs. The way to light is the best one for all looked frames together (joined() in
/// choose_light.h). Throws InputError for a wish that the scene cannot fulfil.
Decisions decide(const PlannedSegment& segment, const Wish& wish, bool media, const SceneSource& source);

/// The spheres around what the camera sees in up to 16 pictures of a segment, evenly spaced, as the content of a view
/// file (formats/plan/view.h). "" if the scene is not much larger than what the camera sees: photons then need no aim,
/// and points lie everywhere. Only the ratio of `width` and `height` counts. `tree`: the static scene's tree, which is
/// built if it is empty.
std::string view_of(const PlannedSegment& segment, int width, int height, const SceneSource& source, StaticTree& tree);

/// Hash of everything that decide() depends on: equal keys mean equal decisions, which a file can keep.
std::string decision_key(const PlannedSegment& segment, const Wish& wish, bool media);

}  // namespace tempolux
