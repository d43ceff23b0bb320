// lib/scene/content_camera.h -- creates a camera for scenes without one.
#pragma once

#include <string>

#include "lib/scene/scene.h"

namespace tempolux {

/// Adds a static camera that shows the scene's content; Scene::camera_node("auto") then finds it. Returns a line for
/// people that gives its position. The camera depends on the scene alone, not on frames, picture size or tool, so all
/// tools use the same camera. docs/methods/content-camera.md has the method, also for large grounds, stray triangles
/// and rooms. Throws InputError if geometry is out of the range of coordinates.
std::string add_content_camera(Scene& scene);

}  // namespace tempolux
