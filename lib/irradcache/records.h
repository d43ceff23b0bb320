// lib/irradcache/records.h -- irradiance records: gathered with gradients, interpolated between.
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

/// Indirect irradiance (kind indirect) at one point, how it changes around it, and how far that holds.
struct IrradianceRecord {
  Vec3 position;                        ///< m, scene space
  Vec3 normal;                          ///< unit, shading normal on the lit side
  Rgb irradiance{0.0f};                 ///< W/m^2
  std::array<Vec3, 3> rotational{};     ///< per channel: E(n) = E + (n_i x n) . g [W/m^2]
  std::array<Vec3, 3> translational{};  ///< per channel: E(x) = E + (x - x_i) . g [W/m^3]
  float radius = 0;                     ///< m: validity, after clamping
  float radius_unclamped = 0;           ///< m: before pixels limited it
  float further_share = 0;              ///< further rays per cell that its unevenness would call for; not in files
  Clearance clearance;                  ///< what was seen around it, about `normal`: beyond it does not count
  std::uint32_t object = 0;             ///< the object it rides on
};

struct InterpolationOptions {
  /// Records whose normal is farther off do not count: n n_i > least_cosine, in [0, 1).
  float least_cosine = 0.94f;
  bool only_read = false;  ///< all records come at once
};

/// least_cosine of records placed with this error bound (lib/gather/place_records.h): on curved surfaces a bright spot
/// rises over the horizon faster than gradients tell, and a ball lit from the side came out 4 % dark there with 20
/// degrees, 1 % with 10. As radii do, the angle follows the bound,
///     1 - least_cosine = 0.375 error_bound^2,   50 degrees x error_bound,
/// but stays from 5 to 20 degrees: normals of fine meshes turn more than that within a pixel, and wider it is wrong.
float least_cosine_of(float error_bound);
/// Cosine of 20 degrees, about.
inline constexpr float kWideCosine = 0.94f;

/// Records found by place: each is listed in the cells its validity sphere meets near its tangent plane, on the level
/// of a hierarchy of hashed grids whose cells are a power of two, from one to two radii wide. What a look-up costs does
/// not grow with the number of records, only with how many overlap there. Look-ups are thread-safe while nothing is
/// added.
class RecordStore {
 public:
  explicit RecordStore(const InterpolationOptions& options = {}) : options_(options) {}

  /// From now on records count in this angle only, if it is the narrower one.
  void narrow(float least_cosine) { options_.least_cosine = std::max(options_.least_cosine, least_cosine); }
  /// n n_i of records that count is above.
  float least_cosine() const { return options_.least_cosine; }

  /// False, and the record is left out and counted, if one of its numbers is not finite or its radius not above 0.
  bool add(const IrradianceRecord& record);
  /// The same for many. A store that is only read takes its records by one call of this: its lists are made once, each
  /// in one piece of memory.
  void add(std::span<const IrradianceRecord> records);
  /// Gives a record a smaller radius. Not of a store that is only read.
  void shrink(std::uint32_t record, float radius);
  std::span<const IrradianceRecord> records() const { return records_; }
  std::uint64_t refused() const { return refused_; }

  struct Interpolated {
    Rgb irradiance{0.0f};  ///< >= 0
    float weight = 0;      ///< sum of the records' weights, each in [0, 1]; 0: no record is valid here
    int count = 0;
  };
  /// Weighted mean of the valid records' extrapolations by their gradients:
  ///
  ///     E = sum w_i (E_i + (n_i x n) . g_r,i + (x - x_i) . g_t,i) / sum w_i
  ///     w_i = (1 - |x - x_i| / r_i) (1 - sqrt((1 - n n_i) / (1 - least_cosine)))      where both are positive
  ///
  /// the hat weights of Tabellion & Lamorlette 2004 and Krivanek, which go to zero at the border of validity, so
  /// that no record is seen to begin. Every extrapolation is clamped at 0. A record is left out if the point is not on
  /// one surface with it: |(x - x_i) . (n + n_i)/2| > 0.05 r_i, which is 0 along circles. Behind it as Ward 1988; in
  /// front as well, or the bright ground below the rim of a plate shines on top of the plate. And if something is in
  /// between (clearance). Where no record counts those in the angle of kWideCosine do.
  Interpolated interpolate(Vec3 position, Vec3 normal) const;
  /// Weighted mean of further_share over the records that are valid at a place; 0 if none is.
  float expected_further_share(Vec3 position, Vec3 normal) const;
  /// Sum of the weights at a record's own place of those added before it, but for those marked (empty: none is).
  float weight_of_earlier(std::uint32_t record, std::span<const std::uint8_t> marked) const;
  /// Is the sum of the weights there at least `weight`? Looks no farther once it is. Or is it, were no radius larger
  /// than least_reach, in the angle of kWideCosine? Where normals turn faster than records may be fine, they need not
  /// be finer.
  bool covers(Vec3 position, Vec3 normal, float weight, float least_reach = 0) const;
  /// Irradiance by interpolate(); none where no record counts.
  std::optional<Rgb> irradiance(Vec3 position, Vec3 normal) const;

 private:
  /// What decides whether a record counts at a point.
  struct Entry {
    Vec3 position;
    float radius;
    Vec3 normal;
    std::uint32_t record;
  };
  /// Entries in eights, so that a look-up compares eight at once: one in twenty is valid where it is listed.
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
    std::uint32_t count_ = 0, last_ = 0;  ///< last_: the record that came last
  };
  struct Level {
    int exponent = 0;  ///< cells are 2^exponent m wide
    double inverse_cell = 0;
    std::size_t listed = 0;  ///< entries in all buckets
    std::vector<std::uint32_t> members;
    std::vector<Bucket> buckets;  ///< by the hash of the cell, a power of two of them: what may be valid in it
    /// If only read, in place of buckets: bucket b is eights[first[b]] to eights[first[b + 1]].
    std::vector<std::uint32_t> first;
    std::vector<Eight> eights;
  };
  Level& level_of(float radius);
  Level* keep(const IrradianceRecord& record);
  void list(Level& level, std::uint32_t record) const;
  /// body(cell) for the cells that a record may be valid in.
  template <class Body>
  void for_each_cell_of(const Level& level, const IrradianceRecord& record, const Body& body) const;
  Entry entry_of(std::uint32_t record) const;
  void pack(Level& level) const;
  /// found(entry) of those that are near and face about the same way (a little more than valid ones), in order, until
  /// true.
  template <class Found>
  static bool any_of(std::span<const Eight> eights, Vec3 position, Vec3 normal, float least_cosine, const Found& found);
  /// Is found(entry) true of a record that may be valid at the point? Each is asked once, until one is.
  template <class Found>
  bool any_near(float least_cosine, Vec3 position, Vec3 normal, const Found& found) const;
  Interpolated interpolate(Vec3 position, Vec3 normal, float least_cosine) const;
  /// Of a record at a point, were its radius another one; 0 where it is not valid.
  float weight_of(const Entry& entry, float radius, float least_cosine, Vec3 position, Vec3 normal) const;
  void accumulate(const Entry& entry, float radius, float least_cosine, Vec3 position, Vec3 normal, Rgb& sum,
                  Interpolated& result) const;

  InterpolationOptions options_;
  std::vector<IrradianceRecord> records_;
  std::vector<Level> levels_;  ///< those that have members, in the order they came
  std::uint64_t refused_ = 0;
};

}  // namespace tempolux
