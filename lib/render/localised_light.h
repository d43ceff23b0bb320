// lib/render/localised_light.h -- indirect light blended between static records and records gathered for the frame.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "lib/gather/localised.h"
#include "lib/scene/moving_objects.h"
#include "lib/scene/surface_point.h"

namespace tempolux {

/// Indirect irradiance [W/m^2] of a frame by localised gathering:
///     E = f E_y + (1 - f) E_t
/// E_y is interpolated between records gathered for the frame. E_t is interpolated between static records: their
/// irradiance includes the changes by movers, their gradients are those of the static irradiance, and negative sums
/// are clamped to 0. f is the gathered share for the influence at the place, and 1 on movers. Method:
/// docs/methods/dynamic.md. Thread-safe.
class LocalisedLight {
 public:
  /// changes[i] belongs to static_records[i]. least_cosine: the smallest cosine between normals for which a record of
  /// either set counts.
  LocalisedLight(std::span<const IrradianceRecord> static_records, std::span<const RecordChange> changes,
                 std::span<const IrradianceRecord> gathered, float least_cosine, const InfluenceThresholds& thresholds,
                 MovingObjects moving);

  /// Empty if a record that the place needs is missing. `noise` [W/m^2] also receives f n_y + (1 - f) n_t, the noise of
  /// both sets of records (RecordStore::Interpolated::noise). Changes by movers add none to n_t.
  std::optional<Rgb> at(const SurfacePoint& surface, Vec3 shading, Rgb* noise = nullptr) const;
  /// f in [0, 1].
  float gathered_share(const SurfacePoint& surface, Vec3 shading) const;
  /// Influence in the unit of the thresholds (InfluenceField::at). Infinite on movers and where no record is valid.
  float influence(const SurfacePoint& surface, Vec3 shading) const;
  const InfluenceThresholds& thresholds() const { return influence_.thresholds(); }

 private:
  InfluenceField influence_;
  RecordStore updated_, gathered_;  ///< E_t, E_y
  MovingObjects moving_;
};

}  // namespace tempolux
