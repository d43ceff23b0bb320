// lib/scene/centre_shutter.h -- the middle of the shutter's open time as the frame's time.
#pragma once

#include "lib/scene/scene.h"

namespace tempolux {

/// Stored light, Z, ids and flow belong to the middle of the shutter. If the shutter of a camera with these extras
/// opens or closes at the frame's time, moves all keys of the scene by half of the open time, so that the scene at a
/// frame is that of the middle, and says in the extras that the middle is the frame's time. The pictures are the same.
/// Lists by frame (focus) and volumes keep their frames. If the open time differs from frame to frame, no move fits all
/// frames and nothing is done.
void centre_shutter(Scene& scene, CameraExtras& extras, double fps);

}  // namespace tempolux
