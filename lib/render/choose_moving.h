// lib/render/choose_moving.h -- does it pay to compute what movers change, instead of each frame's light? Told by a pilot.
#pragma once

#include <cstdint>
#include <string>

#include "lib/render/camera_view.h"
#include "lib/render/path_tracer.h"

namespace tempolux {

/// What of each frame's light follows from that of the scene as it stands: nothing; photons and points; records, too. Or photons and
/// points, and records from those of the frame before.
enum class MovingMethod : std::uint8_t { anew, light, records, time };
inline constexpr const char* kMovingMethods[] = {"anew", "light", "records", "time"};

/// What a pilot saw of a frame and its movers.
struct MovingPilot {
  double touched_share = 0;    ///< of the standing scene's paths: can be met by what moves, or start at what moves
  double gathered_share = 0;   ///< of the places seen: influence above the lower threshold, or on what moves
};

/// 2^16 photon paths through the standing scene, those that movers touch through the whole scene as well, and 2048 places seen:
/// some tenths of a second. Same result for any number of threads.
MovingPilot pilot_moving(const SceneFrame& frame, const EmissionTable& emission, const CameraView& view, std::uint64_t seed);

/// Of a state of light, in shares of what it costs anew; what stands is spread over the states.
struct MovingCost {
  double light = 1, records = 1;   ///< processor time of photons and points; of records
  double photon_bytes = 1;         ///< of files of photons
};

struct MovingChoice {
  MovingMethod method;
  MovingCost cost;
  std::string because;
};

/// With what stands computed once for each of `segments`, `states` of light then cost a share of themselves each:
/// .2 + 3 touched_share for photons and points, .1 + gathered_share for records (docs/methods/dynamic.md has the measurements). Whatever
/// comes out cheaper. Records over time are never chosen: a frame's records follow from those of all states before it in its segment, so a
/// single frame of the middle of a segment costs as much as ten (S5, 320x180: 13.2 CPU s instead of 1.9). They are for whole ranges, by
/// wish.
MovingChoice choose_moving(const MovingPilot& pilot, std::size_t segments, std::size_t states);

/// Processor time of a state's records over time, in shares of what they cost anew: .35, and 1.2 in a segment's first state
/// (docs/methods/temporal.md).
double records_over_time(std::size_t segments, std::size_t states);

}  // namespace tempolux
