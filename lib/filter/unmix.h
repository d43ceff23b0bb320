// lib/filter/unmix.h -- light on surfaces so thin in the picture that no pixel sees them alone: from pixels that see a
// part of them.
#pragma once

#include "lib/filter/coverage.h"
#include "lib/filter/light.h"

namespace tempolux {

/// A pixel whose fit rests on less than this many pixels' light does not know its surface.
inline constexpr float kFewestPixels = 10;

/// Gives every pixel p that sees what the fit cannot know the v that has, by layer and channel, the least sum over q of
///     (radiance(q) - sum of share(n) radiance(n) - share(q) albedo(q) v)^2 / albedo(q)^2.
/// What is not known is p's own surface where the weight of `fitted` is below kFewestPixels (v takes the place of its
/// layers), and else what coverage.other counts (v goes to the result). q: pixels of p's surface in the window that see
/// several surfaces and for which the same is not known; radiance(q): what was collected there; n: q itself and the
/// pixels around it that are known, with their shares of q; radiance(n): what was fitted; share(q): the rest of 1. The
/// fit's own value counts as its weight / `frames` pixels, of a window of so many frames; where it has none, the plain
/// mean of what was collected counts as one. v is not below 0 if that mean is not. Returns by layer the light of what
/// no centre around shows; empty planes where no pixel has a share of such.
std::vector<ColourPlane> unmix(const LightGroup& group, std::size_t half, const Light& collected,
                               const Coverage& coverage, int frames, Light& fitted);

}  // namespace tempolux
