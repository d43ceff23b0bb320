// lib/photon/photon_path.h -- the state of a photon on its path, for the parts of PhotonTracer.
#pragma once

#include "lib/core/arrays.h"
#include "lib/core/random.h"
#include "lib/material/inside.h"
#include "lib/photon/photon_trace.h"

namespace tempolux {

inline constexpr float kLargestPhotonSurvival = 0.9995f;  ///< in a lossless box paths end after 2000 bounces on average

/// Stores the direction of the photon that was stored last.
inline void record_direction(Vec3 wi, PhotonBatch& batch) {
  batch.block.directions.push_back(formats::encode_normal(array_of(wi)));
}

struct PhotonTracer::Path {
  PathRandom random{0, 0};
  Ray ray;
  Rgb flux;
  FluxBalance* balance = nullptr;         ///< of all paths, or of this one
  formats::PhotonPilot* pilot = nullptr;  ///< records what the pilot meets
  bool diffuse_seen = false, specular_seen = false;
  Inside inside;
};

/// The paths of a wave.
struct PhotonTracer::Wave {
  Path paths[kWave];
  PhotonEmission emissions[kWave];
  std::uint32_t alive[kWave];      ///< indices of the paths that go on
  std::uint32_t scattered[kWave];  ///< indices of the paths that a medium has scattered in this bounce
  Hit hits[kWave];                 ///< where the paths `alive` arrive, in their order
  SurfacePoint points[kWave];      ///< the same places
  std::uint64_t touched[kWave];    ///< by path, if movers are watched: intervals whose movers the path can touch
  std::uint8_t* moved = nullptr;   ///< by path: PhotonBatch::moved; null if it is not wanted
};

}  // namespace tempolux
