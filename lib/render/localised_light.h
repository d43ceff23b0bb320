// lib/render/localised_light.h -- indirect light between records that stand and records gathered for the frame.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "lib/gather/localised.h"
#include "lib/scene/moving_objects.h"
#include "lib/scene/surface_point.h"

namespace tempolux {

/// Irradiance of kind indirect [W/m^2] of a frame by localised gathering:
///     E = f E_y + (1 - f) E_t
/// E_y interpolated between records gathered for the frame; E_t between static records that carry what movers change,
/// their gradients those of the static irradiance, cut at 0; f the gathered share of the influence there, 1 on what
/// moves. Method: docs/methods/dynamic.md. Thread-safe.
class LocalisedLight {
 public:
  /// changes[i] of standing[i]. least_cosine: in which records of both count.
  LocalisedLight(std::span<const IrradianceRecord> standing, std::span<const RecordChange> changes,
                 std::span<const IrradianceRecord> gathered, float least_cosine, const InfluenceThresholds& thresholds,
                 MovingObjects moving);

  /// Returns nothing where a record is missing that the place needs.
  std::optional<Rgb> at(const SurfacePoint& surface, Vec3 shading) const;
  /// f, in [0, 1].
  float gathered_share(const SurfacePoint& surface, Vec3 shading) const;
  /// Influence in the thresholds' terms (InfluenceField::at); infinity on what moves and where nothing is known.
  float influence(const SurfacePoint& surface, Vec3 shading) const;
  const InfluenceThresholds& thresholds() const { return influence_.thresholds(); }

 private:
  InfluenceField influence_;
  RecordStore updated_, gathered_;  ///< E_t, E_y
  MovingObjects moving_;
};

}  // namespace tempolux
