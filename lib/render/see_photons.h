// lib/render/see_photons.h -- light of a kind that a camera sees, by photons alone.
#pragma once

#include "formats/photons/photons.h"
#include "lib/density/photon_view.h"
#include "lib/render/camera_view.h"
#include "lib/render/path_tracer.h"

namespace tempolux {

/// What photons of a kind tell of the light that a camera sees directly: radiance, mean of the channels, over the
/// picture.
struct SeenPhotons {
  double mean = 0, mean_error = 0;  ///< and its standard error
  double square = 0;                ///< mean of the square, of 32 x 18 parts of the picture
};

/// Of the photons of this kind, by a camera ray to each. What mirrors show is not counted. Same result for any number
/// of threads.
SeenPhotons see_photons(const RenderScene& scene, const CameraView& view, const PhotonView& photons,
                        formats::PathKind kind);

}  // namespace tempolux
