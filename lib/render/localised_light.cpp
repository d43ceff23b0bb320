#include "lib/render/localised_light.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace tempolux {

LocalisedLight::LocalisedLight(std::span<const IrradianceRecord> static_records, std::span<const RecordChange> changes,
                               std::span<const IrradianceRecord> gathered, float least_cosine,
                               const InfluenceThresholds& thresholds, MovingObjects moving)
    : influence_(static_records, changes, thresholds),
      updated_(least_cosine),
      gathered_(least_cosine),
      moving_(std::move(moving)) {
  std::vector<IrradianceRecord> updated(static_records.begin(), static_records.end());
  for (std::size_t i = 0; i < updated.size(); ++i)
    for (int c = 0; c < 3; ++c) updated[i].irradiance[c] = std::max(0.0f, changes[i].updated_irradiance[c]);
  updated_.add(updated);
  gathered_.add(gathered);
}

std::optional<Rgb> LocalisedLight::at(const SurfacePoint& surface, Vec3 shading, Rgb* noise) const {
  const bool moving = moving_.contains(surface.object);
  if (!moving && !influence_.near_influenced(surface.position, shading)) {
    const RecordStore::Interpolated found = updated_.interpolate(surface.position, shading);
    if (found.weight > 0) {
      if (noise) *noise = found.noise;
      return found.irradiance;
    }
  }
  // This is gathered_share() without near_influenced(), which was asked above.
  const float gathered = moving ? 1 : influence_.thresholds().gathered_share(influence_.at(surface.position, shading));
  Rgb irradiance{0.0f}, records_noise{0.0f};
  for (const auto& [records, share] : {std::pair{&updated_, 1 - gathered}, std::pair{&gathered_, gathered}}) {
    if (!(share > 0)) continue;
    const RecordStore::Interpolated found = records->interpolate(surface.position, shading);
    if (!(found.weight > 0)) return std::nullopt;
    irradiance += found.irradiance * share;
    records_noise += found.noise * share;
  }
  if (noise) *noise = records_noise;
  return irradiance;
}

float LocalisedLight::gathered_share(const SurfacePoint& surface, Vec3 shading) const {
  return moving_.contains(surface.object) ? 1 : influence_.gathered_share(surface.position, shading);
}

float LocalisedLight::influence(const SurfacePoint& surface, Vec3 shading) const {
  return moving_.contains(surface.object) ? INFINITY : influence_.at(surface.position, shading);
}

}  // namespace tempolux
