// lib/filter/unmix.h -- estimates the light of surfaces so thin in the picture that no pixel sees them alone.
#pragma once

#include "lib/filter/coverage.h"
#include "lib/filter/light.h"

namespace tempolux {

/// The light of a surface counts as unknown at a pixel whose fit has less weight than this many pixels.
inline constexpr float kFewestPixels = 10;

/// Estimates unknown light v of a surface (radiance / albedo) from pixels in which the surface covers a part. There are
/// two cases:
/// - The fit at pixel p has a weight below kFewestPixels. v is the light of p's own surface; it replaces
///   `fitted` there.
/// - Pixel p also sees surfaces that no neighbouring centre shows (coverage.other). v is their light and is returned.
///
/// A pixel q with such a part is a mixture: radiance(q) = K(q) + s(q) albedo(q) v. K(q) is the light of the surfaces in
/// q whose light is known, by their shares of q and their fitted light at q or its neighbours; s(q) is the remaining
/// share. Least squares over the pixels q of p's surface within 6 pixels that have the same unknown part:
///     v minimises  sum over q of (radiance(q) - K(q) - s(q) albedo(q) v)^2 / albedo(q)^2
/// for each layer and channel. One more term keeps v close to a first estimate:
/// - In the first case the first estimate is the fit at p, if there is one. It counts as weight / `frames` pixels;
///   `frames` is the number of frames in the window.
/// - Otherwise the first estimate is the mean of radiance / albedo over the pixels q. It counts as one pixel with
///   s = 1/16.
/// v is negative only if this mean is.
///
/// half: 0 or 1, the half of the samples. Returns a plane by layer and channel; empty planes if no pixel has
/// coverage.other.
std::vector<ColourPlane> unmix(const LightGroup& group, std::size_t half, const Light& collected,
                               const Coverage& coverage, int frames, Light& fitted);

}  // namespace tempolux
