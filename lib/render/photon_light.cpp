#include "lib/render/photon_light.h"

#include <bit>

namespace tempolux {
namespace {

constexpr int kAreaProbes = 8;   ///< few: a pixel takes the mean of as many estimates

}  // namespace

PhotonLight::PhotonLight(const Tracer& tracer, std::span<const formats::Photon> photons, Vec3d photon_shift,
                         const PhotonLightOptions& options) {
  options_.neighbours = options.neighbours;
  options_.max_radius = options.max_radius > 0 ? options.max_radius : 0.05f * tracer.frame().bounds.diagonal();
  if (!options.caustic_only) indirect_ = PhotonIndex(photons, kind_bit(formats::PathKind::indirect), photon_shift);
  caustic_radius_ = options.caustic_radius > 0 ? options.caustic_radius : tracer.frame().bounds.diagonal() / 60;
  const DensityOptions density{.neighbours = options.caustic_neighbours, .max_radius = caustic_radius_, .area_probes = kAreaProbes};
  caustic_ = std::make_unique<PointDensity>(tracer, photons, density, kind_bit(formats::PathKind::caustic), photon_shift);
  if (caustic_->empty()) caustic_.reset();
}

/// Its random numbers are drawn for the place: the same for any order of look-ups, others in the next sample.
Rgb PhotonLight::caustic(Vec3 position, Vec3 normal, float& sparse_radius) const {
  sparse_radius = 0;
  if (!caustic_) return Rgb(0.0f);
  const std::uint64_t xy = std::uint64_t(std::bit_cast<std::uint32_t>(position.x)) << 32 | std::bit_cast<std::uint32_t>(position.y);
  float radius = 0;
  const Rgb found =
      caustic_->estimate_sampled(position, normal, PathRandom(xy, std::bit_cast<std::uint32_t>(position.z)), radius);
  if (!(radius < caustic_radius_)) sparse_radius = radius;
  return found;
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
