// lib/render/choose_caustics.h -- is the light that mirrors, glass and gloss send onto matte surfaces worth a photon map, where paths find all other light?
#pragma once

#include <cstdint>
#include <string>

#include "lib/render/choose_indirect.h"

namespace tempolux {

/// What photons of a kind tell of the light that a camera sees directly: radiance, mean of the channels, over the picture.
struct SeenPhotons {
  double mean = 0, mean_error = 0;   ///< and its standard error
  double square = 0;                 ///< mean of the square, of 32 x 18 parts of the picture
};

/// Kind: "caustic" or "indirect". 32768 photon paths, and a camera ray to each photon of that kind: some hundredths of a second. The scene's lights may aim
/// photons where the camera looks. What mirrors show is not counted. Same result for any number of threads.
SeenPhotons see_photons(const RenderScene& scene, const CameraView& view, const char* kind, std::uint64_t seed);

struct CausticChoice {
  bool map;
  std::string because;
};

/// A map where it lowers the picture's squared error by more than it costs. Paths find a caustic by hitting the mirror or glass that
/// sends it, and in it a lamp: of a small one that is so rare that a few paths in a picture carry all of it, as dots; and none can hit a
/// point lamp in a mirror. So the variance of the paths that were tried says too little; docs/methods/caustics.md derives what is used.
CausticChoice choose_caustics(const IndirectPilot& paths, const SeenPhotons& photons);

/// Where paths were chosen and a map of caustics pays: light that paths do not find directly they do not find after a bounce either, so they know neither how
/// much indirect light there is nor how rarely. A room with a pane of glass before the sun. So photons say whether it is 5 % of what surfaces scatter: then records in
/// closed scenes; in open ones gathering if its noise by paths, derived as for caustics, would be more than 5 times that of all other light.
IndirectChoice choose_beside_caustics(const IndirectPilot& paths, const SeenPhotons& caustic, const SeenPhotons& indirect);

}  // namespace tempolux
