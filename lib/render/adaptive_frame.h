// lib/render/adaptive_frame.h -- more samples where pixels are uncertain.
#pragma once

#include "lib/render/frame_renderer.h"

namespace tempolux {

/// options.samples for each pixel, then as many as FrameOptions::pixel_error asks for; frame.mean is empty before.
///
/// A pixel's own samples have no say in how many it gets: the noise that decides is that of its neighbours, whose
/// samples are independent. A pixel whose few samples happened to agree would keep them, and openings through which
/// light is seldom found would come out dark. So there is no bias. docs/pixels.md says how noise becomes a number of
/// samples.
void render_adaptive(const RenderScene& scene, const CameraView& view, const FrameOptions& options,
                     RenderedFrame& frame);

}  // namespace tempolux
