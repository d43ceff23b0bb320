// lib/scene/camera_extras.h -- lens and shutter of a camera, from the custom properties of its node.
#pragma once

#include <string>
#include <vector>

#include "lib/scene/scene.h"

namespace tempolux {

/// Reads lens_mm, f_stop, focus_m, shutter_frames (each a number of at least 0, or a list of such numbers by frame),
/// first_frame and shutter_position (center, start, end) from a node's `extras`, a JSON text. Other properties are not
/// looked at. A value that is none of these is left out with a line in `warnings` that begins with `place`.
CameraExtras read_camera_extras(const std::string& extras, const std::string& place,
                                std::vector<std::string>& warnings);

}  // namespace tempolux
