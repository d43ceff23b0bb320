// lib/plan/decide.h -- decides what a segment needs, from pilots of frames that the segment fixes
// (formats/plan/plan.md).
#pragma once

#include <functional>
#include <span>
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
/// something begins to move or comes to rest. In a segment of a shot the shot's frames have been looked at, so the first
/// and the last one are left out. A frame that shows the same picture as an earlier one is left out. Ascending.
std::vector<int> looked_frames(const PlannedSegment& segment, bool of_shot = false);

/// Makes the decisions of a shot, from which its segments depart only for a reason (decide). `pieces`: Plan::shot. With
/// one piece these are the decisions of that segment. With more, pilots run for the first frame of the first piece, the
/// middle frame of the middle one and the last frame of the last one.
Decisions decide_shot(const std::vector<PlannedSegment>& pieces, const Wish& wish, bool media,
                      const SceneSource& source);

/// Makes the decisions of one segment. Each looked frame has its own pilot. The number of light paths is the largest
/// that a looked frame needs. The way to light is the best one for all looked frames together (joined() in
/// choose_light.h).
///
/// `shot`: decisions of the shot; null: the segment decides alone. The segment takes the shot's way to light, its
/// numbers, its split and its method for movers. It departs from the way only if that way is worse here than the best
/// by more than a factor of kDeparture and twice the error of this factor, which follows from its spread over the
/// looked frames. Throws InputError for a wish that the scene cannot fulfil.
Decisions decide(const PlannedSegment& segment, const Wish& wish, bool media, const SceneSource& source,
                 const Decisions* shot = nullptr);

/// The spheres around what the camera sees in up to 16 frames, evenly spaced, and the shares of the photons that the
/// lights get by pilots in the first, the middle and the last of these frames: the content of a view file
/// (formats/plan/view.h). No spheres if the scene is not much larger than what the camera sees: photons then need no
/// aim, and points lie everywhere. No shares if they would gain little. "" without either. `kinds`: of the photons, as
/// for PhotonOptions::set_kinds. Of `wish` only the ratio of width and height counts. `tree`: the static scene's tree,
/// which is built if it is empty.
std::string view_of(const std::vector<int>& frames, const std::string& kinds, const Wish& wish,
                    const SceneSource& source, StaticTree& tree);
/// All frames between the first frame of the first piece and the last frame of the last piece, both included. view_of()
/// looks at some of these frames.
std::vector<int> frames_of(std::span<const PlannedSegment> pieces);

/// Hash of everything that decide() depends on: equal keys mean equal decisions, which a file can keep.
std::string decision_key(const PlannedSegment& segment, const Wish& wish, bool media);

}  // namespace tempolux
