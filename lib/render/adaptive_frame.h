// lib/render/adaptive_frame.h -- takes more samples in pixels with more noise.
#pragma once

#include "lib/render/frame_renderer.h"

namespace tempolux {

/// Takes options.samples samples of each pixel, then as many more as FrameOptions::pixel_error and seen_error ask for,
/// and measures the noise. frame.mean must have its size and no light. Sets all members of `frame` but `half` and
/// mean_radiance. Same frame for any number of threads.
///
/// The noise of its neighbours decides how many samples a pixel gets. Their samples are independent of the pixel's own,
/// so the picture has no bias. If the pixel's own samples decided, a pixel whose first samples agree by chance would
/// get no more, and pixels whose samples seldom find the light of an opening would stay dark. docs/pixels.md derives
/// the number of samples from the noise.
void render_adaptive(const RenderScene& scene, const CameraView& view, const FrameOptions& options,
                     RenderedFrame& frame);

}  // namespace tempolux
