// lib/filter/unmix.h -- light on surfaces so thin in the picture that no pixel sees them alone: from pixels that see a part of them.
#pragma once

#include "lib/filter/collect.h"
#include "lib/filter/coverage.h"
#include "lib/filter/fit.h"

namespace tempolux {

/// A pixel whose fit rests on less than this many pixels' light does not know its surface.
inline constexpr float kFewestPixels = 10;

/// Gives every pixel p that sees what the fit cannot know the v that has, by layer and channel, the least sum over q of
///     (radiance(q) - sum of share(n) radiance(n) - share(q) albedo(q) v)^2 / albedo(q)^2.
/// What is not known is p's own surface where fitted.support is below kFewestPixels (v takes the place of fitted.light), and else what
/// coverage.other counts (v goes to fitted.other). q: pixels of p's surface in the window that see several surfaces and for which the same is not
/// known; radiance(q): what was collected there; n: q itself and the pixels around it that are known, with their shares of q; radiance(n):
/// what was fitted; share(q): the rest of 1. The fit's own value counts as fitted.support / `frames` pixels, of a window of so many
/// frames; where it has none, the plain mean of what was collected counts as one. v is not below 0 if that mean is not.
void unmix(const LightFrame& frame, const Collected& collected, const Coverage& coverage, int radius, int frames, Fitted& fitted);

}  // namespace tempolux
