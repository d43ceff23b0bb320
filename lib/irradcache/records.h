// lib/irradcache/records.h -- irradiance records with gradients, and interpolation between them.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "lib/core/vec.h"
#include "lib/irradcache/clearance.h"

namespace tempolux {

/// Indirect irradiance (kind indirect) at one point, its gradients, and the radius up to which it is valid.
struct IrradianceRecord {
  Vec3 position;                        ///< m, scene space
  Vec3 normal;                          ///< unit, shading normal on the lit side
  Rgb irradiance{0.0f};                 ///< W/m^2
  std::array<Vec3, 3> rotational{};     ///< per channel: E(n) = E + (n_i x n) . g [W/m^2]
  std::array<Vec3, 3> translational{};  ///< per channel: E(x) = E + (x - x_i) . g [W/m^3]
  float radius = 0;                     ///< m: radius of validity
  float radius_unclamped = 0;           ///< m: before the limits by pixel size
  Clearance clearance;                  ///< the record is not valid outside; spokes lie in the plane of `normal`
  std::uint32_t object = 0;             ///< id.object of the surface
  /// W/m^2: a number with a random sign whose mean square is the variance of `irradiance` (lib/gather/hemisphere.h); 0:
  /// unknown
  Rgb noise{0.0f};
  Rgb points_noise{0.0f};  ///< W/m^2: the part of `noise` that comes from the irradiance points; not in files
};

/// Finds records by place. Each level of the store has a hashed grid of cells, whose width is a power of two. A record
/// belongs to the level whose cells are one to two radii wide, and is listed in the cells in which it may be valid. So
/// the cost of a look-up depends only on the number of overlapping records. Look-ups are thread-safe while nothing is
/// added.
class RecordStore {
 public:
  /// A record counts only if the cosine between its normal and the surface's is above `least_cosine`, in [0, 1). By
  /// default the normals are within 20 degrees.
  explicit RecordStore(float least_cosine = 0.94f) : least_cosine_(least_cosine) {}

  float least_cosine() const { return least_cosine_; }

  /// Refuses and counts a record, and returns false, if one of its numbers is not finite or its radius is not above 0.
  bool add(const IrradianceRecord& record);
  void add(std::span<const IrradianceRecord> records) {
    for (const IrradianceRecord& record : records) add(record);
  }
  /// Gives a record a smaller radius [m].
  void shrink(std::uint32_t record, float radius);
  std::span<const IrradianceRecord> records() const { return records_; }
  std::uint64_t refused() const { return refused_; }

  struct Interpolated {
    Rgb irradiance{0.0f};  ///< >= 0
    Rgb noise{0.0f};       ///< sum w_i noise_i / sum w_i: its mean square is the variance of irradiance
    float weight = 0;      ///< sum of the records' weights, each in [0, 1]; 0: no record is valid here
    int count = 0;
  };
  /// Weighted mean of the valid records' extrapolations by their gradients:
  ///
  ///     E = sum w_i (E_i + (n_i x n) . g_r,i + (x - x_i) . g_t,i) / sum w_i
  ///     w_i = (1 - |x - x_i| / r_i) (1 - sqrt((1 - n n_i) / (1 - least_cosine)))      where both are positive
  ///
  /// The weights are the hats of Tabellion & Lamorlette 2004 and Krivanek. They are zero at the border of validity, so
  /// records have no visible borders. Each extrapolation is clamped at 0. A record is not valid if the point does not
  /// lie on the record's surface: if |(x - x_i) . (n + n_i)/2| > 0.05 r_i. (The left side is 0 along a circle.) Ward
  /// 1988 excludes only points behind the record. But points in front must be excluded, too: otherwise the bright
  /// ground below a plate's rim would light the top of the plate. A record is also not valid outside its clearance.
  ///
  /// The radius that a record would have here cannot exceed the radius of a record at the distance d by more than d
  /// [Krivanek 2006], so it is at most s = min (r_i + d_i). If r_i > s + d_i, then the rays of the record have missed
  /// surfaces that are close here: a record on open ground has a radius of 60 m, and a narrow house between its spokes
  /// may hold the place. Its radius
  /// counts as 2 (s + d_i) - r_i, so the record does not count at all if r_i is above s + d_i by s or more.
  Interpolated interpolate(Vec3 position, Vec3 normal) const;
  /// Sum of the weights that earlier records have at the place of record number `record`. Leaves out records whose
  /// element of `marked` is not 0; `marked` may be empty.
  float weight_of_earlier(std::uint32_t record, std::span<const std::uint8_t> marked) const;
  /// True if the sum of the weights at the place is at least `weight`.
  bool covers(Vec3 position, Vec3 normal, float weight) const;
  /// Calls found(number) for each record that is valid at the place.
  void for_each_valid(Vec3 position, Vec3 normal, const std::function<void(std::uint32_t)>& found) const;
  /// Completes IrradianceRecord::noise of the records from `first` on, which so far is the noise of their gather rays:
  /// multiplies it by `factor` and adds points_noise.
  void complete_noise(std::size_t first, float factor);
  /// Irradiance by interpolate(); nothing where no record counts.
  std::optional<Rgb> irradiance(Vec3 position, Vec3 normal) const;

 private:
  /// The part of a record that decides whether the record may be valid at a point.
  struct Entry {
    Vec3 position;
    float radius;
    Vec3 normal;
    std::uint32_t record;
  };
  /// Eight entries, which a look-up tests at once. (One listed entry in twenty is valid.)
  static constexpr std::size_t kLanes = 8;
  struct alignas(32) Eight {
    float x[kLanes], y[kLanes], z[kLanes], radius[kLanes] = {}, normal_x[kLanes], normal_y[kLanes], normal_z[kLanes];
    std::uint32_t record[kLanes];
  };
  class Bucket {
   public:
    void add(const Entry& entry);
    bool ends_with(std::uint32_t record) const { return count_ > 0 && last_ == record; }
    void set_radius(std::uint32_t record, float radius);
    std::span<const Eight> eights() const { return eights_; }

   private:
    std::vector<Eight> eights_;
    std::uint32_t count_ = 0, last_ = 0;  ///< number of entries; the last record added
  };
  struct Level {
    int exponent = 0;  ///< cells are 2^exponent m wide
    double inverse_cell = 0;
    std::size_t listed = 0;  ///< number of entries in all buckets
    std::vector<std::uint32_t> members;
    /// By the hash of a cell: the records that may be valid in the cell. The number of buckets is a power of two.
    std::vector<Bucket> buckets;
  };
  Level& level_of(float radius);
  void list(Level& level, std::uint32_t record) const;
  /// Calls found(entry), in order, for the entries that may be valid at the point, until found returns true. The test
  /// is slightly wider than that of weight_of(), because the rounding of vector lanes may differ.
  template <class Found>
  bool any_of(std::span<const Eight> eights, Vec3 position, Vec3 normal, const Found& found) const;
  /// Calls found(entry) for records that may be valid at the point, each once, until found returns true. Returns
  /// whether it did.
  template <class Found>
  bool any_near(Vec3 position, Vec3 normal, const Found& found) const;
  /// Weight of a record at a point; 0 where it is not valid.
  float weight_of(const Entry& entry, Vec3 position, Vec3 normal) const;
  static float agreeing(float weight, float radius, float distance, float place_radius);

  float least_cosine_;
  std::vector<IrradianceRecord> records_;
  std::vector<Level> levels_;  ///< levels with members, in the order of their first members
  std::uint64_t refused_ = 0;
};

}  // namespace tempolux
