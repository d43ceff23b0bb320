// lib/temporal/light_jumps.h -- finds frames at which light jumps: lamps are switched, objects appear, vanish or are
// put elsewhere.
#pragma once

#include "lib/scene/at_frame.h"

namespace tempolux {

/// Four consecutive frames of a segment; null outside the segment.
struct FramesInARow {
  const SceneFrame* before_previous = nullptr;
  const SceneFrame* previous = nullptr;
  const SceneFrame* here = nullptr;
  const SceneFrame* next = nullptr;
};

/// True if the lights or a surface jump between `previous` and `here`. A step is the change of flux, or of a surface's
/// place, from one frame to the next. A step is a jump if it is larger than twice the sum of the steps before and after
/// it. A jump of flux must also be larger than 1/16 of the flux of all lights, a jump of a surface larger than 1/16 of
/// the surface's size. Light always jumps if all lamps go on or off, even for a single frame. False if `previous` is
/// null.
bool light_jumps(const FramesInARow& frames);

}  // namespace tempolux
