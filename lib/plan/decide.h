// lib/plan/decide.h -- decides what a segment needs, from pilots of frames that the segment fixes
// (formats/plan/plan.md).
#pragma once

#include <string>
#include <vector>

#include "lib/plan/decisions.h"
#include "lib/plan/frame_pilot.h"
#include "lib/plan/plan.h"

namespace tempolux {

/// Frames of a segment for which pilots run: the first, the middle and the last one, and up to four at which
/// something begins to move or comes to rest. In a segment of a shot the shot's frames have been looked at, so the
/// first and the last one are left out. A frame that shows the same picture as an earlier one is left out. Ascending.
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

/// Decides whether the frames of a segment keep pixels of the shot's middle frame (METHOD=still). The camera must
/// stand. A pilot compares one frame of the segment with the middle frame and estimates w, the work of a frame that
/// keeps pixels over the work of a frame that keeps none. The shot_frames frames of the animation share the middle
/// frame, so each of them also pays the part kFinerStillSamples / shot_frames. Frames keep pixels if 2 w plus this part
/// is below 1, since the pilot finds down to half of the work (docs/methods/still.md). `d`: decisions of the segment.
void decide_still(const PlannedSegment& segment, const PlannedFrame& middle, int shot_frames, const Wish& wish,
                  bool media, const SceneSource& source, Decisions& d);

/// Hash of everything that decide() depends on: equal keys mean equal decisions, which a file can keep.
std::string decision_key(const PlannedSegment& segment, const Wish& wish, bool media);

}  // namespace tempolux
