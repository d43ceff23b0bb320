// lib/render/blurred_means.h -- what the pixels of a blurred picture show on the mean: albedo, normal and depth.
#pragma once

#include <string>
#include <vector>

#include "lib/image/image.h"
#include "lib/render/camera_view.h"
#include "lib/render/path_tracer.h"

namespace tempolux {

class Shutter;

/// Means over a pixel, the lens and the time that the shutter is open, as colour is such a mean. A ray that meets no
/// surface counts as 0. Takes kMeanRays rays a pixel, which do not depend on seed or frame. shutter: may be null.
/// - albedo.R .G .B: are replaced by their means, if `image` has them. A filter divides colour by albedo. If the albedo
///   came from one sharp ray, the quotient would hold the sharp texture, and the filter would print it into the blur.
/// - coverage.mean.N.X .Y .Z, coverage.mean.inverse_Z [1/m]: means of the shading normal, on the side that the ray
///   meets, and of 1 / depth. Added if `channels` has "coverage".
/// - coverage.error.N.X .Y .Z, coverage.error.inverse_Z, coverage.error.albedo.R .G .B (if `image` has albedo): the
///   standard error of the mean, as of independent rays: the root of (variance over the rays / kMeanRays). In a pixel
///   of two surfaces with the shares p and 1 - p, whose values differ by d, it is d sqrt(p (1 - p) / kMeanRays). Rays
///   are stratified, so the true error is smaller.
void add_blurred_means(const RenderScene& scene, const CameraView& view, const Shutter* shutter,
                       const std::vector<std::string>& channels, Image& image);

/// Rays a pixel: with n stratified rays a texture's contrast c leaves noise of c n^-3/4, here 1/23.
inline constexpr int kMeanRays = 64;

}  // namespace tempolux
