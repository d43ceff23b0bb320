#include "lib/render/photon_light.h"

#include "lib/density/photon_reach.h"
#include "lib/gather/point_density.h"

namespace tempolux {
namespace {

constexpr int kAsked = 4;   ///< FootprintOptions::asked

}  // namespace

PhotonLight::PhotonLight(const Tracer& tracer, const PhotonView& photons, Vec3d photon_shift,
                         const PhotonLightOptions& options) {
  options_.neighbours = options.neighbours;
  options_.max_radius = options.max_radius;
  has_indirect_ = !options.caustic_only;
  if (has_indirect_) indirect_ = PhotonIndex(photons.photons, kind_bit(formats::PathKind::indirect), photon_shift);
  if (!(options_.max_radius > 0) && indirect_.size() > 0)
    options_.max_radius = PointDensity::kSparser * photon_reach(indirect_, options.neighbours, options_.min_cos, options_.flattening);
  const FootprintOptions density{.neighbours = options.caustic_neighbours, .max_radius = options.caustic_radius, .asked = kAsked};
  caustic_ = std::make_unique<FootprintDensity>(tracer, photons, density, kind_bit(formats::PathKind::caustic), photon_shift);
  if (caustic_->empty()) caustic_.reset();
}

Rgb PhotonLight::caustic(Vec3 position, const LitSurface& surface) const {
  float smooth_over;
  return caustic_ ? caustic_->estimate(position, surface, smooth_over) : Rgb(0.0f);
}

Rgb PhotonLight::indirect(Vec3 position, Vec3 normal) const {
  if (indirect_.size() == 0) return Rgb(0.0f);
  thread_local NeighbourList scratch;
  return Rgb(estimate_irradiance(indirect_, position, normal, options_, scratch).irradiance);
}

}  // namespace tempolux
