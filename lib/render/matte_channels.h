// lib/render/matte_channels.h -- the shares of a pixel that its camera samples see of each object and material.
#pragma once

#include <string>
#include <vector>

#include "lib/render/frame_renderer.h"

namespace tempolux {

/// Names of mattes (matte_names) by id.object and by index into SceneFrame::materials.
struct MatteNames {
  std::vector<std::string> objects, materials;
  explicit MatteNames(const Scene& scene);
};

/// Adds the channels and attributes of the layers kObjectMattes and kMaterialMattes (cryptomatte.h) if `channels` has
/// "cryptomatte". The share of an object is the number of the pixel's camera samples that meet it first, over the
/// number of all: the samples that `options` and `rendered` say colour has, at their moments and points of the lens.
/// Their rays are traced again, so nothing is stored by sample. Pixels outside options.mask, which have no samples,
/// get kSamplesOfKept. A surface of alpha mode BLEND is met or passed as in colour; glass is met. Media do not hide
/// surfaces. Same channels for any number of threads. Cost: a camera ray per sample, nothing is shaded.
void add_matte_channels(const RenderScene& scene, const CameraView& view, const FrameOptions& options,
                        const RenderedFrame& rendered, const MatteNames& names,
                        const std::vector<std::string>& channels, Image& image);

}  // namespace tempolux
