// lib/filter/regress.h -- fits the light around each pixel to what the pixels show: normal, depth and albedo.
#pragma once

#include <vector>

#include "lib/filter/choose.h"
#include "lib/filter/features.h"
#include "lib/filter/light.h"

namespace tempolux {

/// Fits the radiance of the pixels q = p + (dx, dy) within 9 x 9 around each pixel p, for each half, layer and colour,
/// by the function of q with the least weighted sum of squares
///     a + b dx + c dy + sum over f of d_f (f(q) - f(p))
/// f: the features of a pixel. Returns a, the fitted radiance at p [Bitterli et al., Nonlinearly Weighted First-order
/// Regression for Denoising Monte Carlo Renderings, 2016]. If surfaces share pixels, radiance and features are both
/// linear in the shares, so the fit is exact for up to seven shares that the features tell apart.
///
/// The weight of q is that of non-local means [Buades et al. 2005; Rousselle et al. 2012]: with the radiance g of the
/// group's layers together and its variance v, from the other half of the samples,
///     (1 - d/4)^4 for d from 0 to 4,   d = mean over the 3 x 3 pixels p', q' around p, q of
///     (|g(p') - g(q')|^2 - v(p') - min(v(p'), v(q'))) / (v(p') + v(q')).
/// Pixels outside the picture and pixels whose light is not finite have no weight. Slopes d_f are pulled towards 0: the
/// variance of f over the window counts as larger by the variance of f's mean, so noise of the features is not taken
/// for shares; slopes along x and y by kPull, as in fit.h. A result is negative only if the half's own value is.
///
/// Returns halves by layer, without planes for layers that are black everywhere. `image`: the one of group and
/// features.
std::vector<Halves> regress(const Image& image, const LightGroup& group, const Features& features);

}  // namespace tempolux
