// lib/render/adaptive_frame.h -- takes more samples in pixels with more noise.
#pragma once

#include "lib/render/frame_renderer.h"

namespace tempolux {

/// Takes options.samples samples of each pixel, then as many more as FrameOptions::pixel_error asks for. frame.mean
/// must be empty.
///
/// The noise that decides how many samples a pixel gets is the noise of its neighbours, whose samples are independent
/// of the pixel's own. If a pixel's own samples decided, a pixel whose first samples agree by chance would get no more,
/// and pixels that seldom find the light of an opening would stay dark. So the picture has no bias. docs/pixels.md
/// derives the number of samples from the noise.
void render_adaptive(const RenderScene& scene, const CameraView& view, const FrameOptions& options,
                     RenderedFrame& frame);

}  // namespace tempolux
