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

/// Supplies the scene to pilots.
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

/// Makes the decisions of one segment. Each looked frame has its own pilot. Kinds of light are the union over the
/// looked frames, numbers the maximum. If frames need different methods, records have precedence over gathering, and
/// gathering over paths: a method that suits the brightest case is right for the others. Throws InputError for a wish
/// that the scene cannot fulfil.
Decisions decide(const PlannedSegment& segment, const Wish& wish, bool media, const SceneSource& source);

/// What the camera sees over a segment, as the content of a view file (formats/plan/view.h): up to 16 different
/// pictures, evenly spaced. "" if the scene is not much larger than what is seen, so that photons need no aim and
/// points lie everywhere. `width` and `height` of the pictures in pixels; only their ratio counts. tree: of the static
/// scene, if it was built before.
std::string view_of(const PlannedSegment& segment, int width, int height, const SceneSource& source, StaticTree& tree);

/// Hash of all that decide() depends on, so that its result can be kept in a file.
std::string decision_key(const PlannedSegment& segment, const Wish& wish, bool media);

}  // namespace tempolux
