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

namespace tempolux {

/// Where pilots get the scene from.
struct SceneSource {
  /// The scene at a frame inside the animation; without its media if `with_media` is false.
  std::function<SceneFrame(int frame, bool with_media)> at;
  std::function<EmissionTable(int frame)> emission;  ///< the frozen table of the frame's segment
  int camera_node = 0;
};

/// Frames of a segment that pilots look at: the first, the middle and the last one, and up to four at which something
/// comes or goes after standing still. Frames that show the same as one before them are left out. Ascending.
std::vector<int> looked_frames(const PlannedSegment& segment);

/// Decides for one segment. Each looked frame has its own pilot. Kinds of light are the union over the looked frames;
/// numbers are the largest; records go before gathering and gathering before paths, as a method that is good for the
/// brightest case is right for the others. Throws InputError for a wish that the scene cannot have.
Decisions decide(const PlannedSegment& segment, const Wish& wish, bool media, const SceneSource& source);

/// What a camera sees over a segment, as the content of a view file (formats/plan/view.h): up to 16 different pictures,
/// evenly spread. "" if photons need no aim and points lie everywhere: the scene is not much larger than what is seen.
/// `width`, `height`: of the pictures, pixels; their ratio counts.
std::string view_of(const PlannedSegment& segment, int width, int height, const SceneSource& source);

/// Hash of what decide() depends on, so that its answer can be kept in a file.
std::string decision_key(const PlannedSegment& segment, const Wish& wish, bool media);

}  // namespace tempolux
