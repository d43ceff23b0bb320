// lib/render/feature_means.h -- what the pixels of a picture show on the mean: albedo, normal and depth.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "lib/image/image.h"
#include "lib/render/camera_view.h"
#include "lib/render/path_tracer.h"

namespace tempolux {

class Shutter;

/// Means over a pixel, the lens and the time that the shutter is open, as colour is such a mean. A ray that meets no
/// surface counts as 0. shutter: may be null. edges: 1 for pixels that show several surfaces (add_coverage_channel).
/// These pixels take kMeanRays rays, which do not depend on seed or frame; the other pixels take their centre's ray
/// alone. Empty: the picture is blurred, and all pixels take kMeanRays rays.
/// - coverage.mean.N.X .Y .Z, coverage.mean.inverse_Z [1/m], coverage.mean.albedo.R .G .B: means of the shading normal,
///   on the side that the ray meets, of 1 / depth and of albedo. Added if `channels` has "coverage".
/// - coverage.error.*: the standard error of each mean, as of independent rays: the root of (variance over the rays /
///   kMeanRays). In a pixel of two surfaces with the shares p and 1 - p, whose values differ by d, it is
///   d sqrt(p (1 - p) / kMeanRays). Rays are stratified, so the true error is smaller. 0 where one ray is taken.
/// - albedo.R .G .B: replaced by their means, if the picture is blurred and `image` has them. A filter divides colour
/// by
///   albedo. If the albedo came from one sharp ray, the quotient would hold the sharp texture, and the filter would
///   print it into the blur.
void add_feature_means(const RenderScene& scene, const CameraView& view, const Shutter* shutter,
                       std::span<const std::uint8_t> edges, const std::vector<std::string>& channels, Image& image);

/// Rays a pixel: with n stratified rays a texture's contrast c leaves noise of c n^-3/4, here 1/23.
inline constexpr int kMeanRays = 64;

}  // namespace tempolux
