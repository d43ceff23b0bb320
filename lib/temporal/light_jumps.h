// lib/temporal/light_jumps.h -- frames between which light does not change but jumps: lamps switched, things born, gone
// or put elsewhere.
#pragma once

#include "lib/scene/at_frame.h"

namespace tempolux {

/// Four frames in a row of a segment; null beyond its ends.
struct FramesInARow {
  const SceneFrame* before_last = nullptr;
  const SceneFrame* last = nullptr;
  const SceneFrame* here = nullptr;
  const SceneFrame* next = nullptr;
};

/// Does light, or what is in it, jump between `last` and `here`? It does if the step stands out from those around it,
/// by more than twice their sum, and is larger than 1/16: of the power of all lamps, or, of a surface that moves, of
/// its size. False without `last`.
bool light_jumps(const FramesInARow& frames);

}  // namespace tempolux
