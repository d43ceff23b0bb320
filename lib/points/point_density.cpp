#include "lib/points/point_density.h"

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

PointDensity::Estimate PointDensity::estimate(const IrradiancePoint& point, const PathRandom& random) const {
  thread_local NeighbourList found;
  const auto [found_radius, farthest] = find(point.position, point.normal, found);
  if (found_radius == 0) return {};
  const auto radius = float(found_radius);
  if (!(radius > 4 * area_.offset())) {  // float coordinates do not resolve the disc, so its area is not measured
    const IrradianceEstimate plain =
        estimate_irradiance(index_, point.position, point.normal, {options_.neighbours, options_.max_radius}, found);
    return {Rgb(plain.irradiance), Rgb(0.0f), plain.radius};
  }
  const bool whole = area_.whole(point.position, point.normal, radius, random.get1(2, Purpose::points));
  Rgbd flux{0.0}, signed_flux{0.0};
  bool any = false;
  for (std::size_t i = 0; i < found.count(); ++i) {
    const std::uint32_t photon = found.photons()[i];
    if (i == farthest ||
        !area_.reaches(whole, point.position, point.normal, index_.position(photon), index_.normal(photon)))
      continue;
    flux += Rgbd(index_.flux(photon));
    signed_flux += Rgbd(index_.flux(photon)) * double(signs_[photon]);
    any = true;
  }
  if (!any) return {Rgb(0.0f), Rgb(0.0f), radius};  // as at points inside walls: their area need not be measured
  const double inverse = area_.inverse(whole, point.position, point.normal, radius, options_.area_probes, random);
  const Rgbd positive{std::max(0.0, flux.r), std::max(0.0, flux.g), std::max(0.0, flux.b)};
  return {Rgb(positive * inverse), Rgb(signed_flux * inverse), radius};
}

}  // namespace tempolux
