// lib/plan/looks.h -- looks at frames of a segment until the best way to light is known, and compares it with the
// shot's.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include "lib/plan/frame_pilot.h"

namespace tempolux {

/// The ways of all frames together (joined() in choose_light.h).
std::vector<Way> joined_ways(const std::vector<FrameWays>& looks);
/// The best allowed way, if any is allowed by the user and the scene. Media exclude paths, because photons light media.
std::optional<Way> best_of(const std::vector<Way>& ways, const Wish& wish, bool media);

/// Which frames to look at, and for what.
struct Looking {
  const std::vector<int>& frames;
  const Wish& wish;
  bool media;
  std::function<std::unique_ptr<FramePilot>(int)> pilot_of;   ///< makes the pilot of a frame
  std::function<LightSharing(const FramePilot&)> sharing_of;  ///< how many frames share the light that a pilot rates
  const Decisions* shot;                                      ///< its way must be measured, too; null: there is no shot
};
/// Measures each frame until its own best way has been measured, or until the segment may follow the shot. If the best
/// way of the whole segment is not measured at some of the frames, measures these frames again until it is. Sets
/// `middle` to the pilot of the frame in the middle.
std::vector<FrameWays> look_at(const Looking& looking, std::unique_ptr<FramePilot>& middle, LightSharing& sharing);

/// Does the segment have to depart from the shot's way to light? (decide.h)
bool departs(const std::vector<FrameWays>& looks, const Wish& wish, bool media, const Decisions& shot);

}  // namespace tempolux
