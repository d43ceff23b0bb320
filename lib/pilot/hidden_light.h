// lib/pilot/hidden_light.h -- light that mirrors and smooth glass send on from a lamp. No camera path finds it if the
// lamp has no extent, and few do if the lamp is small: its share of a picture, and the light itself for references.
#pragma once

#include "lib/audit/audit.h"
#include "lib/render/camera_view.h"
#include "lib/render/frame_renderer.h"
#include "lib/render/path_tracer.h"

namespace tempolux {

/// True if a light without extent (point, spot, sun) shines and some material is a mirror or smooth glass.
bool may_hide_light(const SceneFrame& frame);

/// True if add_hidden_light() can find light: some lamp shines, with extent or without, and some material is a mirror
/// or smooth glass.
bool light_paths_find(const SceneFrame& frame, const EmissionTable& table);

/// Mean radiance of the visible caustic light from these lights, estimated by kPilotPaths light paths, over the mean
/// radiance `picture` [W/m^2/sr] of the picture. 1 if the picture is black; 0 if the share is not above `least` by
/// kAuditErrors standard errors. `without_extent`: lights of Lights::Which::punctual, whose photons are aimed where the
/// camera looks. Same result for any number of threads.
double hidden_share(const RenderScene& scene, const Lights& without_extent, const CameraView& view, double picture,
                    double least = kAuditLimit);

/// Adds this light to the layers caustic and indirect of a path-traced picture: `paths` light paths (rounded up to a
/// multiple of PhotonTracer::kBatch) whose first event is at a mirror or smooth glass, each photon connected to the
/// camera (PhotonSplats). `lamps`: lights of Lights::Which::lamps, if RenderScene::without_hidden_light was set for the
/// picture, else of Lights::Which::punctual. Unbiased in each pixel. It does not find the light of lamps without extent
/// where the camera looks through mirrors, glass or gloss (layer specular), or in media (layer volume). Same result for
/// any number of threads.
void add_hidden_light(const RenderScene& scene, const Lights& lamps, const CameraView& view, std::uint64_t paths,
                      std::uint64_t seed, LayerImage& picture);

}  // namespace tempolux
