// lib/photon/photon_path.h -- the state of a photon on its path, for the parts of PhotonTracer.
#pragma once

#include "lib/core/arrays.h"
#include "lib/core/random.h"
#include "lib/material/inside.h"
#include "lib/photon/photon_trace.h"

namespace tempolux {

inline constexpr float kLargestPhotonSurvival = 0.9995f;  ///< in a lossless box paths end after 2000 bounces on average

/// Stores the direction wi of the photon that was stored last: unit, towards the photon's origin.
inline void record_direction(Vec3 wi, PhotonBatch& batch) {
  batch.block.directions.push_back(formats::encode_normal(array_of(wi)));
}

struct PhotonTracer::Path {
  PathRandom random{0, 0};
  Ray ray;
  Rgb flux;
  float wavelength = 0;                   ///< HeroWavelength::nm; 0: the photon is white
  FluxBalance* balance = nullptr;         ///< the balance of the batch, or of this path
  formats::PhotonPilot* pilot = nullptr;  ///< records what the path meets if it is a pilot; else null
  bool diffuse_seen = false, specular_seen = false;
  Inside inside;
};

/// The paths of a wave.
struct PhotonTracer::Wave {
  Path paths[kWave];
  PhotonEmission emissions[kWave];
  std::uint32_t alive[kWave];      ///< indices of the paths that continue
  std::uint32_t scattered[kWave];  ///< indices of the paths that a medium has scattered in this bounce
  Hit hits[kWave];                 ///< where the paths `alive` arrive, in their order
  SurfacePoint points[kWave];      ///< the surface at `hits`
  std::uint64_t touched[kWave];    ///< by path, if movers are watched: bits of MoverWatch::touching(), of all its rays
  std::uint8_t* moved = nullptr;   ///< by path: elements of PhotonBatch::moved; null if they are not wanted
};

}  // namespace tempolux
