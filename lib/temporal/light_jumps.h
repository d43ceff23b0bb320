// lib/temporal/light_jumps.h -- finds frames at which light jumps: lamps are switched, objects appear, vanish or are
// put elsewhere.
#pragma once

#include "lib/scene/at_frame.h"

namespace tempolux {

/// Four consecutive frames of a segment; null outside the segment.
struct FramesInARow {
  const SceneFrame* before_last = nullptr;
  const SceneFrame* last = nullptr;
  const SceneFrame* here = nullptr;
  const SceneFrame* next = nullptr;
};

/// True if the lights, or a surface in their light, jump between `last` and `here`: the step is larger than twice the
/// sum of the steps before and after, and larger than 1/16 of the flux of all lights or of the moving surface's size.
/// If all lamps go on or off, it is a jump in any case, even for one frame. False if `last` is null.
bool light_jumps(const FramesInARow& frames);

}  // namespace tempolux
