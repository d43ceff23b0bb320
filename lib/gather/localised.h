// lib/gather/localised.h -- final gathering only where movers matter [Tawara, Myszkowski, Seidel 2002]
// (docs/methods/dynamic.md).
#pragma once

#include <span>
#include <vector>

#include "lib/points/signed_density.h"
#include "lib/irradcache/points.h"
#include "lib/irradcache/records.h"

namespace tempolux {

/// Thresholds of influence that choose the records for a place. Below `low` light comes from static records changed by
/// dynamic photons (E_t), above `high` from records gathered for the frame (E_y). Between the two both are mixed.
struct InfluenceThresholds {
  float low = 0.06f, high = 0.15f;  ///< shares of the static irradiance

  /// Share of E_y: 0 up to low, 1 from high on, t^2 (3 - 2 t) with t = (I - low) / (high - low) in between.
  float gathered_share(float influence) const;
  float ratio() const { return high / low; }
};

/// The change of a static record by the dynamic photons of a frame.
struct RecordChange {
  Rgb updated_irradiance{0.0f};  ///< E_t [W/m^2]: the record's irradiance plus the change; may be negative
  float influence = 0;           ///< W/m^2
};

/// Computes E_t of each record from the first of `maps`, which belongs to the frame, and its influence as the largest
/// over all maps. The other maps belong to earlier frames, so that the region of influence grows at once and shrinks
/// over several frames. A change is estimated over a disc, whose radius is kWider times the radius of the closest
/// irradiance point. (The disc of that point holds k static photons.) `seed`: of the random numbers of the discs'
/// areas.
std::vector<RecordChange> record_changes(std::span<const IrradianceRecord> records, std::span<const SignedDensity> maps,
                                         const PointLookup& points, std::uint64_t seed);

/// Influence at any place, interpolated between static records in the way of their irradiance. Thread-safe.
class InfluenceField {
 public:
  /// changes[i] belongs to records[i], whose irradiance is that of the static scene.
  InfluenceField(std::span<const IrradianceRecord> records, std::span<const RecordChange> changes,
                 const InfluenceThresholds& thresholds);

  /// Influence as a share of the largest channel of the static irradiance at the place, which counts as at least a
  /// hundredth of the records' mean. Infinite if no record is valid there.
  float at(Vec3 position, Vec3 normal) const;
  /// Share of E_y there: InfluenceThresholds::gathered_share(at()).
  float gathered_share(Vec3 position, Vec3 normal) const;
  /// True if a record whose influence may be above the lower threshold is valid at the place. If it is false and
  /// another record is valid, gathered_share() is 0.
  bool near_influenced(Vec3 position, Vec3 normal) const;
  const InfluenceThresholds& thresholds() const { return thresholds_; }

 private:
  /// at() from an interpolated pair: r is the influence, g the largest channel of the static irradiance, both in W/m^2.
  float relative(Rgb pair) const;

  RecordStore store_;  ///< records whose `irradiance` holds such pairs
  /// The records of store_ whose influence is not below thresholds_.low. (Where only others are valid, the interpolated
  /// influence is below `low`, because a weighted mean of ratios below `low` is below `low`.)
  RecordStore influenced_;
  InfluenceThresholds thresholds_;
  float least_ = 0;  ///< W/m^2: kLeastShare of the records' mean irradiance
};

}  // namespace tempolux
