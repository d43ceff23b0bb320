// lib/scene/content_camera.h -- a camera for scenes that have none.
#pragma once

#include <string>

#include "lib/scene/scene.h"

namespace tempolux {

/// Adds a camera that shows what the scene holds; it stands still. Scene::camera_node("auto") then finds it. Returns a
/// line that says where it stands, for people. Depends on the scene alone: not on frames, picture size or what a tool
/// is for, so that all tools see the same. Method, and what it does with large grounds, strays and rooms:
/// docs/methods/content-camera.md.
///
/// Throws InputError if geometry lies beyond what numbers can hold.
std::string add_content_camera(Scene& scene);

}  // namespace tempolux
