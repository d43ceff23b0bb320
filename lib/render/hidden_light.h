// lib/render/hidden_light.h -- light that no camera path finds: from lights without extent, through mirrors and smooth
// glass.
#pragma once

#include "lib/render/camera_view.h"
#include "lib/render/path_tracer.h"

namespace tempolux {

/// True if a light without extent (point, spot, sun) shines and some material is a mirror or smooth glass.
bool may_hide_light(const SceneFrame& frame);

/// Mean radiance of the visible caustic light from these lights, estimated by kPilotPaths light paths, over the mean
/// radiance `picture` [W/m^2/sr] of the picture. 1 if the picture is black; 0 if the share is not above kAuditLimit by
/// kAuditErrors standard errors. `without_extent`: lights of Lights::Which::punctual, whose photons are aimed where the
/// camera looks. Same result for any number of threads.
double hidden_share(const RenderScene& scene, const Lights& without_extent, const CameraView& view, double picture);

}  // namespace tempolux
