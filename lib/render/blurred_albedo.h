// lib/render/blurred_albedo.h -- albedo of pixels that lens or shutter blur.
#pragma once

#include "lib/image/image.h"
#include "lib/render/camera_view.h"
#include "lib/render/path_tracer.h"

namespace tempolux {

class Shutter;

/// Replaces the channels albedo.* of a blurred picture, if it has them, by means over the pixel, the lens and the time
/// that the shutter is open, as colour is such a mean. A filter divides colour by albedo. If the albedo came from one
/// sharp ray, the quotient would hold the sharp texture, and the filter would print it into the blur. The albedo of a
/// ray that meets no surface is 0. Takes kAlbedoRays rays a pixel. The rays do not depend on seed or frame. shutter:
/// may be null.
void blur_albedo(const RenderScene& scene, const CameraView& view, const Shutter* shutter, Image& image);

/// Rays a pixel: with n stratified rays a texture's contrast c leaves noise of c n^-3/4, here 1/23.
inline constexpr int kAlbedoRays = 64;

}  // namespace tempolux
