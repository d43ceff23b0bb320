#include "lib/density/irradiance_estimate.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <span>
#include <stdexcept>

namespace tempolux {
namespace {

Rgbd sum_flux(const PhotonIndex& index, std::span<const std::uint32_t> photons) {
  Rgbd sum;
  for (std::uint32_t photon : photons) sum += Rgbd(index.flux(photon));
  return sum;
}

IrradianceEstimate divide_by_disc(Rgbd flux, double radius2, std::size_t count) {
  return {flux / (std::numbers::pi * radius2), float(std::sqrt(radius2)), std::uint32_t(count)};
}

}  // namespace

IrradianceEstimate estimate_irradiance(const PhotonIndex& index, Vec3 point, Vec3 normal,
                                       const IrradianceOptions& options, NeighbourList& scratch) {
  if (options.neighbours < 2 || options.neighbours > kMaxNeighbours)
    throw std::invalid_argument("irradiance estimate: neighbours must be 2 to 512");
  if (!(options.max_radius > 0)) throw std::invalid_argument("irradiance estimate: max_radius must be > 0");
  PhotonQuery query{point, normal, options.max_radius, kMinCos, kFlattening};
  index.find_nearest(query, options.neighbours, scratch);
  const std::span<const std::uint32_t> photons = scratch.photons();
  if (photons.size() < std::size_t(options.neighbours)) {
    const double radius = options.max_radius;
    if (!std::isfinite(radius)) return {};
    return divide_by_disc(sum_flux(index, photons), radius * radius, photons.size());
  }
  const float least_radius = std::min(index.resolution(), options.max_radius);
  const std::size_t kth = scratch.farthest();
  const double radius2 = scratch.distance2()[kth];
  if (radius2 > double(least_radius) * least_radius) {
    const Rgbd flux = sum_flux(index, photons.first(kth)) + sum_flux(index, photons.subspan(kth + 1));
    return divide_by_disc(flux, radius2, photons.size() - 1);
  }
  if (!(least_radius > 0)) return {};
  query.max_radius = least_radius;
  index.find_within(query, scratch);
  return divide_by_disc(sum_flux(index, scratch.photons()), double(least_radius) * least_radius, scratch.count());
}

}  // namespace tempolux
