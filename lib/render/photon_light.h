// lib/render/photon_light.h -- the photon map seen directly: irradiance by density for the renderer.
#pragma once

#include "lib/density/irradiance_estimate.h"
#include "lib/render/path_tracer.h"

namespace tempolux {

struct PhotonLightOptions {
  int neighbours = 50;            ///< k of the density estimate
  float max_radius = 0;           ///< m; 0: a twentieth of the scene's diagonal
  bool caustic_only = false;      ///< indirect light comes from elsewhere: index the caustic photons alone
};

/// Caustic and indirect irradiance from the photons of a map, each kind by its own k nearest. Biased: light is
/// blurred over the radius of the estimate and lost at edges and corners within it; the bias falls with the
/// photons' number.
class PhotonLight : public DiffuseLight {
 public:
  /// `photon_shift` is added to photon positions to bring them into scene space (the file's origin minus the
  /// frame's).
  PhotonLight(std::span<const formats::Photon> photons, Vec3d photon_shift, const Box3& bounds,
              const PhotonLightOptions& options);

  Irradiance at(const SurfacePoint& surface, Vec3 geometric, Vec3 shading) const override;
  Rgb caustic(Vec3 position, Vec3 normal) const { return estimate(caustic_, position, normal); }
  std::size_t photon_count() const { return caustic_.size() + indirect_.size(); }

 private:
  Rgb estimate(const PhotonIndex& index, Vec3 position, Vec3 normal) const;

  PhotonIndex caustic_, indirect_;
  IrradianceOptions options_;
};

}  // namespace tempolux
