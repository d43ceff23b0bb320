// lib/plan/view_of.h -- what the cameras of a shot see: the content of a view file.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "lib/plan/frame_pilot.h"

namespace tempolux {

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

}  // namespace tempolux
