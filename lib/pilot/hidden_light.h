// lib/pilot/hidden_light.h -- light that no camera path can find, because mirrors and smooth glass send it on from a
// lamp without extent: its share of a picture, and the light itself for references.
#pragma once

#include "lib/audit/audit.h"
#include "lib/render/camera_view.h"
#include "lib/render/frame_renderer.h"
#include "lib/render/path_tracer.h"

namespace tempolux {

/// True if a light without extent (point, spot, sun) shines and some material is a mirror or smooth glass.
bool may_hide_light(const SceneFrame& frame);

/// Mean radiance of the visible caustic light from these lights, estimated by kPilotPaths light paths, over the mean
/// radiance `picture` [W/m^2/sr] of the picture. 1 if the picture is black; 0 if the share is not above `least` by
/// kAuditErrors standard errors. `without_extent`: lights of Lights::Which::punctual, whose photons are aimed where the
/// camera looks. Same result for any number of threads.
double hidden_share(const RenderScene& scene, const Lights& without_extent, const CameraView& view, double picture,
                    double least = kAuditLimit);

/// Adds this light to the layers caustic and indirect of a path-traced picture: `paths` light paths (rounded up to a
/// multiple of PhotonTracer::kBatch) whose first event is at a mirror or smooth glass, each photon connected to the
/// camera (PhotonSplats). Unbiased in each pixel. It does not find this light where the camera looks through mirrors,
/// glass or gloss (layer specular), or in media (layer volume). Same result for any number of threads.
void add_hidden_light(const RenderScene& scene, const Lights& without_extent, const CameraView& view,
                      std::uint64_t paths, std::uint64_t seed, LayerImage& picture);

}  // namespace tempolux
