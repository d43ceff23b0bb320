// lib/filter/unmix.h -- estimates the light of surfaces so thin in the picture that no pixel sees them alone.
#pragma once

#include "lib/filter/coverage.h"
#include "lib/filter/light.h"

namespace tempolux {

/// A pixel whose fit rests on less than this many pixels' light is treated as a surface without light of its own.
inline constexpr float kFewestPixels = 10;

/// For each pixel p whose light the fit cannot find, estimates this light v by layer and channel. v minimises the sum
/// over q of
///     (radiance(q) - sum of share(n) radiance(n) - share(q) albedo(q) v)^2 / albedo(q)^2.
/// - q: the pixels of p's surface in the window that see several surfaces and lack the same light. radiance(q): the
/// collected radiance there.
/// - n: q and its neighbours, where their light was fitted. share(n): the share of n's surface in q. radiance(n):
/// their fitted radiance.
/// - share(q): the remainder to 1.
/// Where the weight of `fitted` is below kFewestPixels, v is the light of p's own surface and replaces its layers.
/// Elsewhere v is the light of the surfaces that coverage.other counts, and is returned.
///
/// If the fit has a value, it counts as its weight / `frames` pixels, for a window of `frames` frames. If it has
/// none, the plain mean of the collected light counts as one pixel. v is not negative unless that mean is. Returns by
/// layer the light of surfaces that no neighbouring centre shows; empty planes if no pixel has such a share.
std::vector<ColourPlane> unmix(const LightGroup& group, std::size_t half, const Light& collected,
                               const Coverage& coverage, int frames, Light& fitted);

}  // namespace tempolux
