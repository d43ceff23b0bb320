// lib/render/photon_light.h -- irradiance from the photon map by density estimation, for camera paths.
#pragma once

#include <memory>

#include "lib/density/irradiance_estimate.h"
#include "lib/points/footprint_density.h"
#include "lib/trace/trace.h"

namespace tempolux {

struct PhotonLightOptions {
  int neighbours = 50;          ///< k of the density estimate of indirect light, 2 to kMaxNeighbours
  int caustic_neighbours = 25;  ///< fewer, because caustics have edges and a pixel averages several estimates
  bool caustic_only = false;    ///< no indirect light is needed, so only caustic photons are indexed
};
/// FootprintOptions::asked of estimates that a pixel or a pilot averages (docs/methods/caustics.md).
inline constexpr int kAskedPhotons = 8;

/// While an object of this class lives, PhotonLight::caustic on its thread reuses the light that it has estimated. The
/// samples of a pixel usually see one place. A place on the same surface, within the distance over which light changes
/// (FootprintLight::alike_within), gets the light of an earlier place. A pixel then averages the light of a few of its
/// places; the mean over many pixels stays the same. At most one object per thread. Use a new object for each pixel, so
/// that the picture does not depend on the pixels that the thread has rendered before.
class CausticMemory {
 public:
  CausticMemory();
  ~CausticMemory();
  CausticMemory(const CausticMemory&) = delete;
  /// From now on only light that was estimated for this half (0 or 1) of the samples is reused, so that the halves
  /// stay independent.
  void use_half(int half);
};

/// Caustic and indirect irradiance from the photons of a map: caustic light by footprints (FootprintDensity), indirect
/// light by the k nearest photons, within the radius that follows from the photons' spacing (photon_reach). Biased:
/// estimates blur light over their radius, and indirect light is too dark at edges and corners. The bias falls with the
/// number of photons. Thread-safe. The tracer must outlive this object.
class PhotonLight {
 public:
  /// photon_shift [m] is added to photon positions to bring them into scene space: the file's origin minus the frame's.
  PhotonLight(const Tracer& tracer, const PhotonView& photons, Vec3d photon_shift, const PhotonLightOptions& options);

  /// Caustic light [W/m^2] on the lit side of the surface, and its noise. 0 without caustic photons.
  FootprintLight caustic(Vec3 position, const LitSurface& surface) const;
  /// Indirect irradiance [W/m^2] on the side of the geometric normal (unit). 0 unless has_indirect().
  Rgb indirect(Vec3 position, Vec3 normal) const;
  /// False with PhotonLightOptions::caustic_only.
  bool has_indirect() const { return has_indirect_; }
  std::size_t photon_count() const { return (caustic_ ? caustic_->photon_count() : 0) + indirect_.size(); }

 private:
  bool has_indirect_ = false;
  std::unique_ptr<FootprintDensity> caustic_;  ///< null if the map has no caustic photon
  PhotonIndex indirect_;
  IrradianceOptions options_;
};

}  // namespace tempolux
