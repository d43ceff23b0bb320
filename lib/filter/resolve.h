// lib/filter/resolve.h -- pixels at edges put together from the surfaces they see.
#pragma once

#include "lib/filter/coverage.h"
#include "lib/filter/light_frame.h"

namespace tempolux {

/// For each pixel p that sees several surfaces
///     share(p) own(p) + sum over the pixels n around of share(n) own(n) + share(other) other(p),
/// own: a plane of what each pixel's own surface has; shares by coverage. Other pixels keep their bits of `own`.
Plane resolved(const Plane& own, const Plane& other, const Coverage& coverage, int width, int height);

/// The same of a plane that passes the filter, in place: LightFrame::inside pixels keep their bits. At edges a sample may be of any surface, one that
/// covers less of the pixel than coverage counts among them: what each surface has is the mean over inside pixels on it nearby
/// (5 x 5), where there are none the pixel's own value. What coverage.other counts is taken to have as much as the pixel's own surface.
void resolve_passing(const LightFrame& frame, const Coverage& coverage, Plane& plane);

}  // namespace tempolux
