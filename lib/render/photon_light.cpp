#include "lib/render/photon_light.h"

#include "lib/density/photon_reach.h"
#include "lib/gather/point_density.h"

namespace tempolux {

PhotonLight::PhotonLight(const Tracer& tracer, std::span<const formats::Photon> photons, Vec3d photon_shift,
                         const PhotonLightOptions& options) {
  options_.neighbours = options.neighbours;
  options_.max_radius = options.max_radius;
  if (!options.caustic_only) indirect_ = PhotonIndex(photons, kind_bit(formats::PathKind::indirect), photon_shift);
  if (!(options_.max_radius > 0) && indirect_.size() > 0)
    options_.max_radius = PointDensity::kSparser * photon_reach(indirect_, options.neighbours, options_.min_cos, options_.flattening);
  const FootprintOptions density{options.caustic_neighbours, options.caustic_radius, kSparseReach};
  caustic_ = std::make_unique<FootprintDensity>(tracer, photons, density, kind_bit(formats::PathKind::caustic), photon_shift);
  if (caustic_->empty()) caustic_.reset();
}

Rgb PhotonLight::caustic(Vec3 position, Vec3 normal, float& sparse_radius) const {
  sparse_radius = 0;
  return caustic_ ? caustic_->estimate(position, normal, sparse_radius) : Rgb(0.0f);
}

Rgb PhotonLight::indirect(Vec3 position, Vec3 normal) const {
  if (indirect_.size() == 0) return Rgb(0.0f);
  thread_local NeighbourList scratch;
  return Rgb(estimate_irradiance(indirect_, position, normal, options_, scratch).irradiance);
}

DiffuseLight::Irradiance PhotonLight::at(const SurfacePoint& surface, Vec3 geometric, Vec3, bool, const Rgb* caustic_light) const {
  Irradiance result;
  result.caustic = caustic_light ? *caustic_light : caustic(surface.position, geometric, result.sparse_radius);
  result.indirect = indirect(surface.position, geometric);
  return result;
}

}  // namespace tempolux
