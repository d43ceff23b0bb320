// lib/render/localised_light.h -- indirect light blended between static records and records gathered for the frame.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "lib/gather/localised.h"
#include "lib/scene/moving_objects.h"
#include "lib/scene/surface_point.h"

namespace tempolux {

/// Indirect irradiance E [W/m^2] of a frame by localised gathering:
///     E = f E_y + (1 - f) E_t
/// - E_y: interpolated between the records that were gathered for the frame.
/// - E_t: interpolated between the static records. Each record's irradiance is its static irradiance plus the change by
///   movers, or 0 if this sum is negative; its gradients are of the static irradiance alone.
/// - f: gathered_share(), which grows with the influence at the place; 1 on movers.
/// Method: docs/methods/dynamic.md. Thread-safe.
class LocalisedLight {
 public:
  /// changes[i] belongs to static_records[i]. A record counts at places where the cosine between the normals is at
  /// least least_cosine.
  LocalisedLight(std::span<const IrradianceRecord> static_records, std::span<const RecordChange> changes,
                 std::span<const IrradianceRecord> gathered, float least_cosine, const InfluenceThresholds& thresholds,
                 MovingObjects moving);

  /// E [W/m^2] at a place with the shading normal `shading`. Empty if f needs a set of records of which none is valid
  /// at the place. `noise` [W/m^2] receives f n_y + (1 - f) n_t, with the noise n_y, n_t of the two sets
  /// (RecordStore::Interpolated::noise); n_t does not include noise of the changes.
  std::optional<Rgb> at(const SurfacePoint& surface, Vec3 shading, Rgb* noise = nullptr) const;
  /// f in [0, 1].
  float gathered_share(const SurfacePoint& surface, Vec3 shading) const;
  /// Influence over the static irradiance (InfluenceField::at). Infinite on movers and where no record is valid.
  float influence(const SurfacePoint& surface, Vec3 shading) const;
  const InfluenceThresholds& thresholds() const { return influence_.thresholds(); }

 private:
  InfluenceField influence_;
  RecordStore updated_, gathered_;  ///< E_t, E_y
  MovingObjects moving_;
};

}  // namespace tempolux
