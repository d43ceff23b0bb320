// lib/gather/localised.h -- final gathering only where movers matter [Tawara, Myszkowski, Seidel 2002]
// (docs/methods/dynamic.md).
#pragma once

#include <span>
#include <vector>

#include "lib/gather/signed_density.h"
#include "lib/irradcache/points.h"
#include "lib/irradcache/records.h"

namespace tempolux {

/// Where what movers change is taken from: below `low` from the static records and the dynamic photons (E_t), above
/// `high` from records gathered for the frame (E_y), in between from both.
struct InfluenceThresholds {
  float low = 0.06f, high = 0.15f;  ///< shares of the static irradiance

  /// Share of E_y: 0 up to low, 1 from high on, t^2 (3 - 2 t) with t = (I - low) / (high - low) in between.
  float gathered_share(float influence) const;
};

/// DensityOptions::area_probes of dynamic maps for record_changes(). Eight columns spread over a disc tell its area to
/// some 15 %: of a change that is a hundredth of the light as a rule, .15 % of the light.
inline constexpr int kChangeProbes = 8;

/// What the dynamic photons of a frame do to a static record.
struct RecordChange {
  Rgb update{0.0f};     ///< W/m^2: E_t = irradiance + change, not cut at 0
  float influence = 0;  ///< W/m^2
};

/// E_t of each record from the first of `maps`, its influence the largest over all of them (the frame's own and those
/// before it: the region grows at once and shrinks over frames). The disc is seven times as wide as that of the
/// irradiance point nearest to the record, which k static photons fill.
std::vector<RecordChange> record_changes(std::span<const IrradianceRecord> records, std::span<const SignedDensity> maps,
                                         const PointLookup& points, std::uint64_t seed);

/// Influence between static records, interpolated as their irradiance is. Thread-safe.
class InfluenceField {
 public:
  /// influences[i] of records[i], which carry their static irradiance.
  InfluenceField(std::span<const IrradianceRecord> records, std::span<const float> influences,
                 const InfluenceThresholds& thresholds);

  /// In the thresholds' terms: divided by the largest channel of the static irradiance there (at least a hundredth of
  /// the records' mean) unless they are absolute. Infinity where no record is near.
  float at(Vec3 position, Vec3 normal) const;
  /// Does a record above the lower threshold count there? If not and any record counts, E_y has no share: a mean of
  /// influences over a mean of irradiances is at most the largest of their ratios. Most places have none.
  bool is_above_low(Vec3 position, Vec3 normal) const;
  /// Share of E_y there: at() by the thresholds. 1 where all records that count are above the upper one.
  float gathered_share(Vec3 position, Vec3 normal) const;
  const InfluenceThresholds& thresholds() const { return thresholds_; }

 private:
  /// Influence in the thresholds' terms; pair: influence (r), static irradiance (g).
  float relative(Rgb pair) const;

  /// Of influence (r) and static irradiance (g) as if they were irradiance: all records, those above the lower
  /// threshold, those below the upper one.
  RecordStore store_, above_, below_;
  InfluenceThresholds thresholds_;
  float least_ = 0;  ///< W/m^2
};

}  // namespace tempolux
