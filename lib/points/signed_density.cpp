#include "lib/points/signed_density.h"

#include <algorithm>
#include <cmath>

#include "lib/core/sampling.h"
#include "lib/density/photon_reach.h"

namespace tempolux {
namespace {

double largest(Rgb flux) { return double(std::max({std::abs(flux.r), std::abs(flux.g), std::abs(flux.b)})); }

}  // namespace

SignedDensity::SignedDensity(const Tracer& static_tracer, std::span<const formats::Photon> photons,
                             const DensityOptions& options, Vec3d shift)
    : options_(options), area_(static_tracer), index_(photons, kind_bit(formats::PathKind::indirect), shift) {
  if (!(options_.max_radius > 0) && index_.size() > 0)
    options_.max_radius = PointDensity::kSparser * photon_reach(index_, options_.neighbours);
}

void SignedDensity::find(Vec3 position, Vec3 normal, float& radius, const PathRandom& random, Area& area,
                         NeighbourList& found) const {
  if (!(radius > 0 && std::isfinite(radius))) radius = options_.max_radius;
  index_.find_within({position, normal, radius, kMinCos, kFlattening}, found);
  if (found.count() == 0 || area.known) return;
  area.known = true;
  area.whole = area_.whole(position, normal, radius, random.get1(2, Purpose::points));
  area.inverse = area_.inverse(area.whole, position, normal, radius, options_.area_probes, random);
}

double SignedDensity::most_influence(Vec3 position, Vec3 normal, float radius, const PathRandom& random,
                                     Area& area) const {
  thread_local NeighbourList found;
  find(position, normal, radius, random, area, found);
  double sum = 0;
  for (std::size_t i = 0; i < found.count(); ++i)
    if (found.distance2()[i] < radius * radius) sum += largest(index_.flux(found.photons()[i]));
  return sum * area.inverse;
}

std::optional<SignedDensity::Change> SignedDensity::at(Vec3 position, Vec3 normal, float radius,
                                                       const PathRandom& random, Area& area) const {
  thread_local NeighbourList found;
  find(position, normal, radius, random, area, found);
  if (found.count() == 0) return std::nullopt;
  Change change;
  for (std::size_t i = 0; i < found.count(); ++i) {
    // A photon on the border does not count, as in the static estimate.
    if (!(found.distance2()[i] < radius * radius)) continue;
    const std::uint32_t photon = found.photons()[i];
    if (!area_.reaches(area.whole, position, normal, index_.position(photon), index_.normal(photon))) continue;
    const Rgb flux = index_.flux(photon);
    change.irradiance += Rgbd(flux);
    change.influence += largest(flux);
  }
  change.irradiance *= area.inverse;
  change.influence *= area.inverse;
  return change;
}

}  // namespace tempolux
