#include "lib/gather/point_density.h"

#include <algorithm>
#include <cmath>

#include "lib/core/sampling.h"
#include "lib/density/irradiance_estimate.h"
#include "lib/density/path_signs.h"
#include "lib/density/photon_reach.h"

namespace tempolux {

PointDensity::PointDensity(const Tracer& tracer, std::span<const formats::Photon> photons,
                           const DensityOptions& options, std::uint8_t kinds, Vec3d shift)
    : options_(options), area_(tracer), index_(photons, kinds, shift), signs_(path_signs(photons, index_)) {
  if (!(options_.max_radius > 0))
    options_.max_radius = kSparser * photon_reach(index_, options_.neighbours, options_.where);
}

/// The k nearest photons, or all within max_radius.
PointDensity::Disc PointDensity::find(Vec3 position, Vec3 normal, NeighbourList& found) const {
  const PhotonQuery query{position, normal, options_.max_radius, kMinCos, kFlattening};
  index_.find_nearest(query, options_.neighbours, found);
  if (found.count() == 0) return {};
  if (int(found.count()) < options_.neighbours) return {options_.max_radius, found.count()};
  const std::size_t farthest = found.farthest();
  return {std::sqrt(found.distance2()[farthest]), farthest};
}

/// The estimate for radii that float coordinates do not resolve.
Rgb PointDensity::plain(Vec3 position, Vec3 normal, float& radius, NeighbourList& found) const {
  const IrradianceEstimate estimate =
      estimate_irradiance(index_, position, normal, {options_.neighbours, options_.max_radius}, found);
  radius = estimate.radius;
  return Rgb(estimate.irradiance);
}

Rgb PointDensity::estimate(const IrradiancePoint& point, const PathRandom& random, float& radius, Rgb* noise) const {
  thread_local NeighbourList found;
  const auto [found_radius, farthest] = find(point.position, point.normal, found);
  radius = float(found_radius);
  if (radius == 0) return Rgb(0.0f);
  if (!(radius > 4 * area_.offset())) return plain(point.position, point.normal, radius, found);
  const bool whole = area_.whole(point.position, point.normal, radius, random.get1(2, Purpose::points));
  // In a whole disc everything in its plane is reachable. A sheet close above the plane may still belong to another
  // side.
  const auto counts = [&](std::uint32_t photon) {
    const Vec3 place = index_.position(photon);
    return (whole && std::abs(dot(place - point.position, point.normal)) < 4 * area_.offset()) ||
           area_.reach()(point.position, point.normal, place, index_.normal(photon));
  };
  Rgbd flux{0.0}, signed_flux{0.0};
  bool any = false;
  for (std::size_t i = 0; i < found.count(); ++i) {
    const std::uint32_t photon = found.photons()[i];
    if (i == farthest || !counts(photon)) continue;
    flux += Rgbd(index_.flux(photon));
    signed_flux += Rgbd(index_.flux(photon)) * double(signs_[photon]);
    any = true;
  }
  if (!any) return Rgb(0.0f);
  const double inverse = whole ? 1 / (double(kPi) * double(radius) * double(radius))
                               : area_.inverse(point.position, point.normal, radius, options_.area_probes,
                                               ReachableArea::Kernel::flat, random);
  if (noise) *noise = Rgb(signed_flux * inverse);
  return Rgb(Rgbd{std::max(0.0, flux.r), std::max(0.0, flux.g), std::max(0.0, flux.b)} * inverse);
}

}  // namespace tempolux
