// lib/render/see_photons.h -- light of one kind that a camera sees, estimated from photons alone.
#pragma once

#include "formats/photons/photons.h"
#include "lib/density/photon_view.h"
#include "lib/render/camera_view.h"
#include "lib/render/path_tracer.h"

namespace tempolux {

/// Radiance of one kind of light that a camera sees, as the mean over the channels and the picture.
struct SeenPhotons {
  double mean = 0, mean_error = 0;  ///< mean and its standard error
  double square = 0;                ///< mean of the square, over 16 x 9 parts of the picture
};

/// The same of the two kinds of light that paths may miss.
struct SeenLight {
  SeenPhotons caustic, indirect;
};

/// Sums the photons of each kind that a camera ray reaches directly, which is unbiased. Camera rays that reach a place
/// through mirrors and glass add a density of photons there: in the middle of a wall at most 20 % too bright
/// (docs/methods/caustics.md). Same result for any number of threads.
SeenLight see_photons(const RenderScene& scene, const CameraView& view, const PhotonView& photons);

}  // namespace tempolux
