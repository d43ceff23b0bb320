// lib/scene/camera_extras.h -- lens and shutter of a camera, from the custom properties of its node.
#pragma once

#include <string>
#include <vector>

#include "lib/scene/scene.h"

namespace tempolux {

/// Reads the properties of the table in camera_properties.h that have a key, and first_frame, from a node's `extras`, a
/// JSON text. Numbers are at least 0, and may be lists of numbers by frame. Other properties are not looked at. A value
/// that a property cannot have is left out with a line in `warnings` that begins with `place`.
CameraExtras read_camera_extras(const std::string& extras, const std::string& place,
                                std::vector<std::string>& warnings);

/// Replaces where the frame's time lies in the time that the shutter is open.
void set_shutter_position(CameraExtras& extras, Camera::Shutter position);

}  // namespace tempolux
