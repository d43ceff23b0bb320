// lib/render/adaptive_frame.h -- more samples where pixels are uncertain, and less noise where shadows are certain.
#pragma once

#include "lib/render/frame_renderer.h"

namespace tempolux {

/// options.samples for each pixel, then more where FrameOptions::pixel_error asks for them; frame.mean is empty before.
///
/// Where Lights::has_large() their light is controlled (LightControl): with C the noise that a pixel's samples of them would
/// have without shadows, it gets
///     max(0, L - b C),   b: the share of their light that the neighbours' first samples saw.
/// C is 0 in the mean and independent of b: no bias, whatever b is, but for the few values below 0, at the edges of black
/// shadows. Where all of their light is seen the noise is gone, where none is nothing changes.
///
/// Where a penumbra begins or ends one sample of a pixel may differ from all of its neighbours', who call for no more: a dot. If it
/// and the eight around it see one matte surface each, it gets samples until one is worth 4 pixel errors. They move its mean towards
/// what is seen around it; as much is taken from, or given to, the neighbours on its surface in equal parts. So an area's mean has
/// no bias; some thousandths of a pixel's light are those of the area within two pixels.
///
/// A lamp smaller than a pixel in a curved mirror is met by one sample of many, and its pixel then shows ten times what it
/// should; neighbours that met none call for no more. If by all its samples (of what has edges) a pixel would ask for
/// more than twice as many as it got, it gets them (caches and photons only), and its neighbours what that took from it likewise.
void render_adaptive(const RenderScene& scene, const CameraView& view, const FrameOptions& options, RenderedFrame& frame);

}  // namespace tempolux
