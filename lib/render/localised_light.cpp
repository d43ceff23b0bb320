#include "lib/render/localised_light.h"

#include <algorithm>
#include <cmath>

namespace tempolux {
namespace {

std::vector<float> influences_of(std::span<const RecordChange> changes) {
  std::vector<float> influences;
  for (const RecordChange& change : changes) influences.push_back(change.influence);
  return influences;
}

}  // namespace

LocalisedLight::LocalisedLight(std::span<const IrradianceRecord> static_records, std::span<const RecordChange> changes,
                               std::span<const IrradianceRecord> gathered, float least_cosine,
                               const InfluenceThresholds& thresholds, MovingObjects moving)
    : influence_(static_records, influences_of(changes), thresholds),
      updated_({.least_cosine = least_cosine}),
      gathered_({.least_cosine = least_cosine}),
      moving_(std::move(moving)) {
  std::vector<IrradianceRecord> updated(static_records.begin(), static_records.end());
  for (std::size_t i = 0; i < updated.size(); ++i)
    for (int c = 0; c < 3; ++c) updated[i].irradiance[c] = std::max(0.0f, changes[i].update[c]);
  updated_.add(updated);
  gathered_.add(gathered);
}

std::optional<Rgb> LocalisedLight::at(const SurfacePoint& surface, Vec3 shading) const {
  const float share = gathered_share(surface, shading);
  Rgb sum{0.0f};
  if (share < 1) {
    const std::optional<Rgb> updated = updated_.irradiance(surface.position, shading);
    if (!updated) return std::nullopt;
    sum = *updated * (1 - share);
  }
  if (share > 0) {
    const std::optional<Rgb> gathered = gathered_.irradiance(surface.position, shading);
    if (!gathered) return std::nullopt;
    sum += *gathered * share;
  }
  return sum;
}

float LocalisedLight::gathered_share(const SurfacePoint& surface, Vec3 shading) const {
  return moving_.contains(surface.object) ? 1 : influence_.gathered_share(surface.position, shading);
}

float LocalisedLight::influence(const SurfacePoint& surface, Vec3 shading) const {
  return moving_.contains(surface.object) ? INFINITY : influence_.at(surface.position, shading);
}

}  // namespace tempolux
