// lib/filter/unmix.h -- estimates the light of surfaces so thin in the picture that no pixel sees them alone.
#pragma once

#include "lib/filter/coverage.h"
#include "lib/filter/light.h"

namespace tempolux {

/// The light of a surface counts as unknown at a pixel whose fit has less weight than this many pixels.
inline constexpr float kFewestPixels = 10;

/// Estimates the light v (radiance / albedo) of surfaces that cover only parts of pixels. There are two cases at a
/// pixel p:
/// - Own: the fit at p has a weight below kFewestPixels. v is the light of p's own surface and replaces `fitted` at p.
/// - Other: p also sees surfaces that no neighbouring centre shows (coverage.other). v is the light of these surfaces
///   and is returned.
///
/// v is estimated from the pixels q around p, up to 6 pixels away in x and in y, that show the same surface as p and
/// have the same kind of unknown part as p. Such a pixel is a mixture:
///     radiance(q) = K(q) + s(q) albedo(q) v
/// K(q) is the sum over the known surfaces in q: each surface's share of q times its fitted light at q or at a
/// neighbour of q, times albedo. s(q) is the remaining share. For each layer and channel v minimises
///     sum over q of (radiance(q) - K(q) - s(q) albedo(q) v)^2 / albedo(q)^2.
/// The sum has one more term, which keeps v close to a first estimate:
/// - Own: the first estimate is the fit at p. It counts as many pixels as the weight of the fit, divided by `frames`,
///   the number of frames in the window.
/// - Other, or if there is no fit at p: the first estimate is the mean of radiance / albedo over the pixels q. It
///   counts as one pixel with s = 1/16.
/// v is 0 or more if the mean of radiance / albedo over the pixels q is.
///
/// half: 0 or 1, the half of the samples. Returns planes by layer and channel. They are empty if no pixel has
/// coverage.other.
std::vector<ColourPlane> unmix(const LightGroup& group, std::size_t half, const Light& collected,
                               const Coverage& coverage, int frames, Light& fitted);

}  // namespace tempolux
