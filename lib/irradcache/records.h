// lib/irradcache/records.h -- irradiance records with gradients, and interpolation between them.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
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
  Clearance clearance;                  ///< the record does not count outside of it; measured about `normal`
  std::uint32_t object = 0;             ///< the object it lies on
  /// W/m^2: number with a random sign whose mean square is the variance of `irradiance` (lib/gather/hemisphere.h); 0:
  /// unknown
  Rgb noise{0.0f};
  Rgb points_noise{0.0f};  ///< W/m^2: the part of `noise` from the points that were read; not in files
};

struct InterpolationOptions {
  /// A record counts if the cosine between its normal and the surface's is above least_cosine, in [0, 1): within 20
  /// degrees.
  float least_cosine = 0.94f;
};

/// Finds records by place. A record is listed in the cells that its validity sphere meets near its tangent plane. The
/// cells belong to hashed grids, one per level; cell sizes are powers of two, from one to two radii. The cost of a
/// look-up grows with the number of overlapping records only. Look-ups are thread-safe while nothing is added.
class RecordStore {
 public:
  explicit RecordStore(const InterpolationOptions& options = {}) : options_(options) {}

  /// Records count above this cosine between normals.
  float least_cosine() const { return options_.least_cosine; }

  /// False, and the record is refused and counted, if one of its numbers is not finite or its radius not above 0.
  bool add(const IrradianceRecord& record);
  void add(std::span<const IrradianceRecord> records) {
    for (const IrradianceRecord& record : records) add(record);
  }
  /// Gives a record a smaller radius.
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
  /// with the hat weights of Tabellion & Lamorlette 2004 and Krivanek, which are zero at the border of validity, so
  /// that records have no visible borders. Every extrapolation is clamped at 0. A record is not valid if the point
  /// does not lie on the record's surface: |(x - x_i) . (n + n_i)/2| > 0.05 r_i (0 along circles). Ward 1988 tests
  /// only points behind the record. Points in front matter, too: the bright ground below a plate's rim would light
  /// the top of the plate. A record is not valid either if an obstacle lies between (clearance).
  Interpolated interpolate(Vec3 position, Vec3 normal) const;
  /// Sum of the weights, at a record's own place, of the records added before it, except the marked ones (`marked` may
  /// be empty).
  float weight_of_earlier(std::uint32_t record, std::span<const std::uint8_t> marked) const;
  /// True if the sum of the weights is at least `weight`; stops as soon as it is.
  bool covers(Vec3 position, Vec3 normal, float weight) const;
  /// Multiplies IrradianceRecord::noise of the records from `first` on, which is that of their rays, and adds
  /// points_noise.
  void complete_noise(std::size_t first, float factor);
  /// Irradiance by interpolate(); nothing where no record counts.
  std::optional<Rgb> irradiance(Vec3 position, Vec3 normal) const;

 private:
  /// The data that decides whether a record counts at a point.
  struct Entry {
    Vec3 position;
    float radius;
    Vec3 normal;
    std::uint32_t record;
  };
  /// Entries in groups of eight, which a look-up compares at once: one in twenty listed entries is valid.
  static constexpr std::size_t kLanes = 8;
  struct alignas(32) Eight {
    float x[kLanes], y[kLanes], z[kLanes], radius[kLanes] = {}, normal_x[kLanes], normal_y[kLanes], normal_z[kLanes];
    std::uint32_t record[kLanes];
    void set(std::size_t lane, const Entry& entry);
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
    /// records that may be valid in a cell, by the hash of the cell; the number of buckets is a power of two
    std::vector<Bucket> buckets;
  };
  Level& level_of(float radius);
  void list(Level& level, std::uint32_t record) const;
  /// Calls found(entry), in order, for the entries that a slightly widened test of place and normal accepts, until
  /// found returns true.
  template <class Found>
  bool any_of(std::span<const Eight> eights, Vec3 position, Vec3 normal, const Found& found) const;
  /// True if found(entry) is true for a record that may be valid at the point. Each record is tried once, until one is
  /// found.
  template <class Found>
  bool any_near(Vec3 position, Vec3 normal, const Found& found) const;
  /// Weight of a record at a point; 0 where it is not valid.
  float weight_of(const Entry& entry, Vec3 position, Vec3 normal) const;
  void accumulate(const Entry& entry, Vec3 position, Vec3 normal, Rgb& sum, Interpolated& result) const;

  InterpolationOptions options_;
  std::vector<IrradianceRecord> records_;
  std::vector<Level> levels_;  ///< levels with members, in the order of their first members
  std::uint64_t refused_ = 0;
};

}  // namespace tempolux
