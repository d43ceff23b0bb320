// lib/render/choose_moving.h -- does it pay to compute what movers change, instead of each frame's light? Told by a
// pilot.
#pragma once

#include <cstdint>
#include <string>

#include "lib/render/camera_view.h"
#include "lib/render/path_tracer.h"

namespace tempolux {

/// What of each frame's light follows from that of the scene as it stands: nothing; photons and points; records, too.
/// Or photons and points, and records from those of the frame before.
enum class MovingMethod : std::uint8_t { anew, light, records, time };
inline constexpr const char* kMovingMethods[] = {"anew", "light", "records", "time"};

/// What a pilot saw of a frame and its movers.
struct MovingPilot {
  double touched_share = 0;   ///< of the standing scene's paths: can be met by what moves, or start at what moves
  double gathered_share = 0;  ///< of the places seen: influence above the lower threshold, or on what moves
};

/// 2^16 photon paths through the standing scene, those that movers touch through the whole scene as well, and 2048
/// places seen: some tenths of a second. Same result for any number of threads.
MovingPilot pilot_moving(const SceneFrame& frame, const EmissionTable& emission, const CameraView& view,
                         std::uint64_t seed);

struct MovingChoice {
  MovingMethod method;
  std::string because;
};

/// What comes out cheapest for `states` of light. With what stands computed once, a state's photons and points cost
/// 1 / states + .2 + 3 touched_share of what they cost anew, and its records standing_records + .1 + gathered_share
/// (docs/methods/dynamic.md has the measurements). standing_records: what records of what stands cost for each frame
/// that they serve, in records of a frame. Records over time are never chosen: a frame's records follow from those of
/// all states before it in its segment, so a single frame of the middle of a segment costs as much as ten (S5,
/// 320x180: 13.2 CPU s instead of 1.9). They are for whole ranges, by wish.
MovingChoice choose_moving(const MovingPilot& pilot, std::size_t states, double standing_records);

}  // namespace tempolux
