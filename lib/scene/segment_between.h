// lib/scene/segment_between.h -- any interval of frames as a segment.
#pragma once

#include "lib/scene/at_frame.h"

namespace tempolux {

/// The frames `first` to `last` as a segment, wherever borders lie. If options.fps is k times the scene's rate, frames
/// are steps of 1 / k frame. Then the segment also finds what moves between frames. Throws as segment_of().
Segment segment_between(const Scene& scene, int first, int last, const TimeOptions& options);

}  // namespace tempolux
