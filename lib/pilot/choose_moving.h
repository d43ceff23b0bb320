// lib/pilot/choose_moving.h -- a pilot decides what frames with movers reuse of the static scene's light.
#pragma once

#include <cstdint>
#include <string>

#include "lib/render/camera_view.h"
#include "lib/render/path_tracer.h"

namespace tempolux {

/// Least cost of the records of a state of light over their cost without reuse (docs/methods/dynamic.md).
inline constexpr double kLeastRecords = 0.1;

/// What a frame reuses. anew: nothing. light: photons and points of the static scene. records: photons, points and
/// records of the static scene. time: photons and points of the static scene, and the records of the frame before.
enum class MovingMethod : std::uint8_t { anew, light, records, time };
inline constexpr const char* kMovingMethods[] = {"anew", "light", "records", "time"};

/// Measurements of a pilot in a frame with movers.
struct MovingPilot {
  double touched_share = 0;  ///< share of the static scene's light paths that a mover touches
  /// Share of the visible places that lie on a mover or have an influence above the lower threshold.
  double gathered_share = 0;
};

/// `emission`: that of scene.lights. Traces kPilotPaths light paths through the static scene, traces those that movers
/// touch through the whole scene as well, and looks at kPilotPlaces visible places. Takes some tenths of a second. Same
/// result for any number of threads.
MovingPilot pilot_moving(const RenderScene& scene, const EmissionTable& emission, const CameraView& view,
                         std::uint64_t seed);

struct MovingChoice {
  MovingMethod method;
  std::string because;
  int static_ray_factor = 1;  ///< gather rays of a static record over those of a record of one state of light
};

/// The cheapest method for `states` states of light, and the reason as text. If the static scene is computed once,
/// photons and points of a state cost 1 / states + .2 + 3 touched_share of their full cost, and its records cost
/// static_records + .1 + gathered_share of theirs (docs/methods/dynamic.md has the measurements). static_records: the
/// cost of the static records per frame that uses them, over the cost of one frame's records. The method `time` is
/// never chosen: the records of a frame then depend on all states before it in the segment, so a single frame in the
/// middle of a segment costs as much as ten (S5, 320x180: 13.2 CPU s instead of 1.9).
///
/// static_ray_factor is 1 or 2, whichever is nearer to the factor with the least product of the work of a picture's
/// records and their squared error. Static records alone light the share 1 - g of what is seen (g = gathered_share) and
/// cost s = static_records; records of a state light the rest and cost .1 + g. So the product
///     (s f + .1 + g) ((1 - g) / f + g)
/// is least at f = sqrt((1 - g) (.1 + g) / (s g)). With more than 2 the records for one frame that is made alone would
/// cost more than twice as much as its own (as for Decisions::together).
MovingChoice choose_moving(const MovingPilot& pilot, std::size_t states, double static_records);

}  // namespace tempolux
