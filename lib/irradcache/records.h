// lib/irradcache/records.h -- irradiance records: gathered with gradients, interpolated between.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "lib/core/vec.h"

namespace tempolux {

/// Indirect irradiance (kind indirect) at one point, how it changes around it, and how far that holds.
struct IrradianceRecord {
  Vec3 position;                        ///< m, scene space
  Vec3 normal;                          ///< unit, shading normal on the lit side
  Rgb irradiance{0.0f};                 ///< W/m^2
  std::array<Vec3, 3> rotational{};     ///< per channel: E(n) = E + (n_i x n) . g [W/m^2]
  std::array<Vec3, 3> translational{};  ///< per channel: E(x) = E + (x - x_i) . g [W/m^3]
  float radius = 0;                     ///< m: validity, after clamping
  float radius_unclamped = 0;           ///< m: before it was limited by pixels, scene and neighbours
  std::uint32_t object = 0;             ///< the object it rides on
};

struct InterpolationOptions {
  float max_angle_cos = 0.8f;           ///< records whose normal is farther off than this do not count
};

/// Records found by place: each is listed in the cells its validity sphere meets, on the level of a hierarchy of
/// grids whose cells are about as large as it. Adding keeps earlier answers' cost; look-ups are thread-safe while
/// nothing is added.
class RecordStore {
 public:
  explicit RecordStore(const Box3& bounds, const InterpolationOptions& options = {});

  void add(const IrradianceRecord& record);
  std::span<const IrradianceRecord> records() const { return records_; }

  struct Interpolated {
    Rgb irradiance{0.0f};               ///< >= 0
    float weight = 0;                   ///< sum of the records' weights, each in [0, 1]; 0: no record is valid here
    int count = 0;
  };
  /// Weighted mean of the valid records' extrapolations by their gradients:
  ///
  ///     E = sum w_i (E_i + (n_i x n) . g_r,i + (x - x_i) . g_t,i) / sum w_i
  ///     w_i = (1 - |x - x_i| / r_i) (1 - sqrt((1 - n n_i) / (1 - cos_max)))      where both are positive
  ///
  /// the hat weights of Tabellion & Lamorlette 2004 and Krivanek, which go to zero at the border of validity, so
  /// that no record is seen to begin. A record whose half space does not hold the point is left out
  /// [Ward 1988]: (x - x_i) . (n + n_i)/2 < -0.05 r_i.
  Interpolated interpolate(Vec3 position, Vec3 normal) const;
  /// The same with every record's radius kRelaxed times as large: for the few points, fractions of a pixel beyond
  /// an edge, that no record quite reaches. Slower.
  Interpolated interpolate_relaxed(Vec3 position, Vec3 normal) const;

  static constexpr float kRelaxed = 3;

 private:
  void accumulate(std::uint32_t record, Vec3 position, Vec3 normal, float scale, Rgb& sum, Interpolated& result) const;
  struct Level {
    float cell = 0;
    std::vector<std::vector<std::uint32_t>> buckets;   // hashed cells
  };
  static std::size_t bucket_of(std::int64_t x, std::int64_t y, std::int64_t z, std::size_t mask);

  Vec3 lower_;
  float largest_cell_;
  InterpolationOptions options_;
  std::vector<IrradianceRecord> records_;
  std::vector<Level> levels_;                          // level l has cells of largest_cell / 2^l
};

}  // namespace tempolux
