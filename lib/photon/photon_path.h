// lib/photon/photon_path.h -- a photon on its way, for the parts of PhotonTracer.
#pragma once

#include "lib/core/random.h"
#include "lib/material/inside.h"
#include "lib/photon/photon_trace.h"

namespace tempolux {

inline constexpr float kLargestPhotonSurvival =
    0.9995f;  ///< in a lossless box paths end after 2000 bounces in the mean

struct PhotonTracer::Path {
  PathRandom random{0, 0};
  Ray ray;
  Rgb flux;
  FluxBalance* balance = nullptr;         ///< of all paths, or its own
  formats::PhotonPilot* pilot = nullptr;  ///< takes down what it meets
  bool diffuse_seen = false, specular_seen = false;
  Inside inside;
};

}  // namespace tempolux
