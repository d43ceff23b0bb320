// lib/render/photon_light.h -- the photon map seen directly: irradiance by density for the renderer.
#pragma once

#include <memory>

#include "lib/density/irradiance_estimate.h"
#include "lib/gather/footprint_density.h"
#include "lib/trace/trace.h"

namespace tempolux {

struct PhotonLightOptions {
  int neighbours = 50;          ///< k of the density estimate of indirect light
  float max_radius = 0;         ///< m; 0: from the photons' spacing
  int caustic_neighbours = 25;  ///< fewer: caustics have edges, and a pixel averages several estimates
  float caustic_radius = 0;     ///< m; 0: likewise
  bool caustic_only = false;    ///< indirect light comes from elsewhere: index the caustic photons alone
};

/// While one of these lives, its thread remembers the caustic light that it looks up: for the samples of one pixel,
/// which see one place as a rule. A place near a remembered one of the same surface, nearer than light changes there
/// (FootprintDensity::estimate_around), has its light. What a pixel shows is then the light of a few of its places in
/// place of all: the same in the mean. One at a time in a thread; made anew for each pixel, so that results do not
/// depend on which pixels a thread has seen before.
class CausticMemory {
 public:
  CausticMemory();
  ~CausticMemory();
  CausticMemory(const CausticMemory&) = delete;
  /// From now on what was looked up for this half of the samples, 0 or 1, and nothing of the other: halves stay
  /// independent.
  void use_half(int half);
};

/// Caustic and indirect irradiance from the photons of a map, by footprints and by the k nearest. Biased: light is
/// blurred over the radius of the estimate, and indirect light is lost at edges and corners within it; the bias falls
/// with the photons' number. Caustic light is divided by the area that can be reached (FootprintDensity):
/// right on slender things too, where it is uniform over them. Without caustic photons nothing is built for them.
class PhotonLight {
 public:
  /// `photon_shift` is added to photon positions to bring them into scene space (the file's origin minus the
  /// frame's).
  PhotonLight(const Tracer& tracer, const PhotonView& photons, Vec3d photon_shift, const PhotonLightOptions& options);

  /// Irradiance [W/m^2] by light of kind caustic, on the lit side of the surface.
  Rgb caustic(Vec3 position, const LitSurface& surface) const;
  /// The same of kind indirect, on the side of the normal (unit, geometric); only if has_indirect(). Normal maps count
  /// by their finest level.
  Rgb indirect(Vec3 position, Vec3 normal) const;
  bool has_indirect() const { return has_indirect_; }
  std::size_t photon_count() const { return (caustic_ ? caustic_->photon_count() : 0) + indirect_.size(); }

 private:
  bool has_indirect_ = false;
  std::unique_ptr<FootprintDensity> caustic_;  ///< null: no photon is of that kind
  PhotonIndex indirect_;
  IrradianceOptions options_;
};

}  // namespace tempolux
