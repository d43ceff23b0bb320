// lib/render/photon_light.h -- irradiance from the photon map by density estimation, for camera paths.
#pragma once

#include <memory>

#include "lib/density/irradiance_estimate.h"
#include "lib/gather/footprint_density.h"
#include "lib/trace/trace.h"

namespace tempolux {

struct PhotonLightOptions {
  int neighbours = 50;          ///< k of the density estimate of indirect light
  float max_radius = 0;         ///< m; 0: from the photons' spacing
  int caustic_neighbours = 25;  ///< fewer, because caustics have edges and a pixel averages several estimates
  float caustic_radius = 0;     ///< m; 0: from the photons' spacing
  bool caustic_only = false;    ///< index caustic photons only; indirect light is not needed
};

/// While an object of this class lives, its thread remembers the caustic light that it looks up for the samples of one
/// pixel, which usually see one place. A place on the same surface, closer than the distance over which light changes
/// (FootprintLight::alike_within), gets the remembered light. A pixel then shows the light of a few of its places
/// instead of all, which is the same in the mean. Only one object per thread; a new one for each pixel, so that results
/// do not depend on which pixels a thread has rendered before.
class CausticMemory {
 public:
  CausticMemory();
  ~CausticMemory();
  CausticMemory(const CausticMemory&) = delete;
  /// From now on only light that was looked up for this half (0 or 1) of the samples is reused, so that halves stay
  /// independent.
  void use_half(int half);
};

/// Caustic and indirect irradiance from the photons of a map: caustic light by footprints, indirect light by the k
/// nearest photons. Biased: light is blurred over the radius of the estimate, and indirect light is lost at edges and
/// corners; the bias falls with the number of photons. Caustic light is divided by the reachable area
/// (FootprintDensity), so it is also correct on slender objects if it is uniform over them. Without caustic photons, no
/// index is built for them.
class PhotonLight {
 public:
  /// photon_shift [m] is added to photon positions to bring them into scene space: the file's origin minus the frame's.
  PhotonLight(const Tracer& tracer, const PhotonView& photons, Vec3d photon_shift, const PhotonLightOptions& options);

  /// Caustic light on the lit side of the surface, and its noise.
  FootprintLight caustic(Vec3 position, const LitSurface& surface) const;
  /// Indirect irradiance [W/m^2] on the side of the normal (unit, geometric); call only if has_indirect(). Normal maps
  /// are read at their finest level.
  Rgb indirect(Vec3 position, Vec3 normal) const;
  bool has_indirect() const { return has_indirect_; }
  std::size_t photon_count() const { return (caustic_ ? caustic_->photon_count() : 0) + indirect_.size(); }

 private:
  bool has_indirect_ = false;
  std::unique_ptr<FootprintDensity> caustic_;  ///< null if the map has no caustic photon
  PhotonIndex indirect_;
  IrradianceOptions options_;
};

}  // namespace tempolux
