// lib/photon/photon_path.h -- the state of a photon on its path, for the parts of PhotonTracer.
#pragma once

#include "lib/core/random.h"
#include "lib/material/inside.h"
#include "lib/photon/photon_trace.h"

namespace tempolux {

inline constexpr float kLargestPhotonSurvival = 0.9995f;  ///< in a lossless box paths end after 2000 bounces on average

struct PhotonTracer::Path {
  PathRandom random{0, 0};
  Ray ray;
  Rgb flux;
  FluxBalance* balance = nullptr;         ///< of all paths, or of this one
  formats::PhotonPilot* pilot = nullptr;  ///< records what the pilot meets
  bool diffuse_seen = false, specular_seen = false;
  Inside inside;
};

}  // namespace tempolux
