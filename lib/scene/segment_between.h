// lib/scene/segment_between.h -- any interval of frames as a segment.
#pragma once

#include "lib/scene/at_frame.h"

namespace tempolux {

/// The frames `first` to `last` as a segment, wherever borders lie. With options.fps times k the frames are steps of
/// 1 / k frame: so what moves while a shutter is open is found between frames, too. Throws as segment_of().
Segment segment_between(const Scene& scene, int first, int last, const TimeOptions& options);

}  // namespace tempolux
