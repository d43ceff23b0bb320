// lib/warp/flow_of_view.h -- computes the pixel flow of a view from the scene at its frame and at the two neighbouring
// frames.
#pragma once

#include "lib/image/pixel_flow.h"
#include "lib/warp/object_motion.h"
#include "lib/warp/scene_view.h"

namespace tempolux {

/// The scene and its camera at a neighbouring frame.
struct NeighbourView {
  const SceneFrame* frame = nullptr;
  const FrameCamera* camera = nullptr;
};

/// Flow as in formats/flow/flow.md. A point of a rigid object follows the object's transform, in double precision. A
/// point of a deforming object follows the corners of its triangle. A point at infinity keeps its direction in world
/// space. fps: frames per second.
PixelFlow flow_of_view(const SceneView& view, const NeighbourView& next, const NeighbourView& previous, double fps);

/// Angular speed, degrees per second, of a point seen in directions a and b (camera space) one frame apart.
double angular_speed(Vec3d a, Vec3d b, double fps);

}  // namespace tempolux
