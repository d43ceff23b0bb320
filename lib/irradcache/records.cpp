#include "lib/irradcache/records.h"

#include <immintrin.h>

#include <algorithm>
#include <bit>
#include <cmath>

#include "lib/core/check.h"
#include "lib/core/random.h"

namespace tempolux {
namespace {

constexpr int kFinest = 40;               ///< smallest cells: largest / 2^kFinest, below float spacing
constexpr std::size_t kFirstBuckets = 256;
constexpr float kOffPlane = 0.05f;        ///< of the radius: how far off the plane between the normals a point may be
constexpr double kOffPlaneSlack = 1e-4;
constexpr double kRounding = 1e-6;        ///< distances are of float: a sphere may reach this much farther

struct Cell {
  std::int64_t x, y, z;
};

Cell cell_at(Vec3d local, double inverse) {
  // Beyond 2^60 cells (records far outside the scene) all is one cell.
  const auto index = [&](double x) { return std::int64_t(std::floor(std::clamp(x * inverse, -0x1p60, 0x1p60))); };
  return {index(local.x), index(local.y), index(local.z)};
}

/// The cells that a validity sphere meets.
template <class Body>
void for_each_cell(Vec3d local, float radius, double inverse_cell, const Body& body) {
  const double reach = double(radius) * (1 + kRounding);
  const Cell low = cell_at(local - Vec3d{1, 1, 1} * reach, inverse_cell);
  const Cell high = cell_at(local + Vec3d{1, 1, 1} * reach, inverse_cell);
  const double width = 1 / inverse_cell;
  // Squared distance to a cell along one axis, if there are several.
  const auto beyond2 = [&](double centre, std::int64_t cell, std::int64_t first, std::int64_t last) {
    if (first == last) return 0.0;
    const double d = std::max({0.0, double(cell) * width - centre, centre - double(cell + 1) * width});
    return d * d;
  };
  for (std::int64_t x = low.x; x <= high.x; ++x)
    for (std::int64_t y = low.y; y <= high.y; ++y) {
      const double aside2 = beyond2(local.x, x, low.x, high.x) + beyond2(local.y, y, low.y, high.y);
      for (std::int64_t z = low.z; z <= high.z; ++z)
        if (aside2 + beyond2(local.z, z, low.z, high.z) <= reach * reach) body(Cell{x, y, z});
    }
}

std::size_t bucket_of(Cell c, std::size_t count) {
  const std::uint64_t h = std::uint64_t(c.x) * 0x9e3779b97f4a7c15ull + std::uint64_t(c.y) * 0xc2b2ae3d27d4eb4full +
                          std::uint64_t(c.z) * 0x165667b19e3779f9ull;
  return std::size_t(mix64(h)) & (count - 1);
}

bool is_usable(const IrradianceRecord& r) {
  bool finite = is_finite(r.position) && is_finite(r.normal) && std::isfinite(channel_sum(r.irradiance));
  for (std::size_t c = 0; c < 3; ++c) finite = finite && is_finite(r.rotational[c]) && is_finite(r.translational[c]);
  return finite && std::isfinite(r.radius) && r.radius > 0;
}

}  // namespace

float least_cosine_of(float error_bound) {
  return 1 - std::clamp(0.375f * error_bound * error_bound, 0.00375f, 1 - kWideCosine);
}

RecordStore::RecordStore(const Box3& bounds, const InterpolationOptions& options)
    : lower_(bounds.empty() ? Vec3{} : bounds.lower), largest_cell_(std::max(double(bounds.diagonal()), 1e-30)), options_(options) {}

void RecordStore::Bucket::add(const Entry& entry) {
  const std::size_t lane = count_++ % kLanes;
  if (lane == 0) eights_.emplace_back();
  Eight& last = eights_.back();
  last.x[lane] = entry.position.x;
  last.y[lane] = entry.position.y;
  last.z[lane] = entry.position.z;
  last.radius[lane] = entry.radius;
  last.normal_x[lane] = entry.normal.x;
  last.normal_y[lane] = entry.normal.y;
  last.normal_z[lane] = entry.normal.z;
  last.record[lane] = last_ = entry.record;
}

void RecordStore::Bucket::set_radius(std::uint32_t record, float radius) {
  for (std::size_t i = 0; i < count_; ++i)
    if (Eight& eight = eights_[i / kLanes]; eight.record[i % kLanes] == record) eight.radius[i % kLanes] = radius;
}

template <class Found>
inline bool RecordStore::Bucket::any_near(Vec3 position, Vec3 normal, float least_cosine, const Found& found) const {
  constexpr float kSlack = 1e-5f;   // rounding differs between lanes and one by one: that decides
  const auto all = [](float x) { return _mm256_set1_ps(x); };
  const __m256 least = all(least_cosine - kSlack), reach = all(1 + kSlack);
  for (const Eight& e : eights_) {
    const auto of = [](const float* lanes) { return _mm256_load_ps(lanes); };
    const __m256 dx = all(position.x) - of(e.x), dy = all(position.y) - of(e.y), dz = all(position.z) - of(e.z), r = of(e.radius);
    const __m256 cosine = all(normal.x) * of(e.normal_x) + all(normal.y) * of(e.normal_y) + all(normal.z) * of(e.normal_z);
    const __m256 near = _mm256_cmp_ps(dx * dx + dy * dy + dz * dz, r * r * reach, _CMP_LT_OQ);
    for (int lanes = _mm256_movemask_ps(_mm256_and_ps(near, _mm256_cmp_ps(cosine, least, _CMP_GT_OQ))); lanes; lanes &= lanes - 1) {
      const auto i = std::size_t(std::countr_zero(unsigned(lanes)));
      if (found(Entry{{e.x[i], e.y[i], e.z[i]}, e.radius[i], {e.normal_x[i], e.normal_y[i], e.normal_z[i]}, e.record[i]})) return true;
    }
  }
  return false;
}

/// The level whose cells are between one and two radii wide.
RecordStore::Level& RecordStore::level_of(float radius) {
  const int exponent = std::clamp(int(std::floor(std::log2(largest_cell_ / double(radius)))), 0, kFinest);
  for (Level& level : levels_)
    if (level.exponent == exponent) return level;
  Level& level = levels_.emplace_back();
  level.exponent = exponent;
  level.inverse_cell = std::ldexp(1 / largest_cell_, exponent);
  level.buckets.resize(kFirstBuckets);
  if (!options_.only_read) level.around.resize(kFirstBuckets);
  return level;
}

/// Valid are points next to the plane between the normals: with t across n_i, n = n_i cos a + t sin a,
///     |d . (n + n_i)| <= 2 kOffPlane r   and   |d| < r
/// give
///     |d . n_i| <= r (2 kOffPlane / (1 + cos a) + tan(a / 2)),
/// the more the larger the angle. Cells beyond that need not know the record.
void RecordStore::list(Level& level, std::uint32_t record) const {
  const IrradianceRecord& r = records_[record];
  const Vec3d local = Vec3d(r.position) - lower_, normal(r.normal);
  const double c = double(std::min(options_.least_cosine, kWideCosine)), width = 1 / level.inverse_cell;
  const double off =
      double(r.radius) * (2 * double(kOffPlane) / (1 + c) + std::sqrt((1 - c) / (1 + c)) + kOffPlaneSlack);
  const double reach = off + width / 2 * (std::abs(normal.x) + std::abs(normal.y) + std::abs(normal.z));
  const Entry entry{r.position, r.radius, r.normal, record};
  for_each_cell(local, r.radius, level.inverse_cell, [&](Cell cell) {
    const Vec3d middle{(double(cell.x) + 0.5) * width, (double(cell.y) + 0.5) * width, (double(cell.z) + 0.5) * width};
    const std::size_t at = bucket_of(cell, level.buckets.size());
    const auto put = [&](Bucket& bucket) {
      if (bucket.ends_with(record)) return false;   // two cells of one hash: once
      bucket.add(entry);
      return true;
    };
    if (!options_.only_read) put(level.around[at]);
    if (std::abs(dot(middle - local, normal)) <= reach) level.listed += put(level.buckets[at]);
  });
}

bool RecordStore::add(const IrradianceRecord& record) {
  if (!is_usable(record)) {
    ++refused_;
    return false;
  }
  const auto index = std::uint32_t(records_.size());
  records_.push_back(record);
  if (double(record.radius) > largest_cell_) {
    everywhere_.add({record.position, record.radius, record.normal, index});
    return true;
  }
  Level& level = level_of(record.radius);
  level.members.push_back(index);
  if (level.listed < 4 * level.buckets.size()) {
    list(level, index);
    return true;
  }
  level.buckets.assign(4 * level.buckets.size(), {});
  if (!options_.only_read) level.around.assign(level.buckets.size(), {});
  level.listed = 0;
  for (std::uint32_t member : level.members) list(level, member);
  return true;
}

/// A smaller radius: the record stays on its level and in its cells.
void RecordStore::shrink(std::uint32_t record, float radius) {
  const float before = records_[record].radius;
  if (double(before) > largest_cell_) everywhere_.set_radius(record, radius);
  for (Level& level : levels_) {
    if (!std::binary_search(level.members.begin(), level.members.end(), record)) continue;
    const Vec3d local = Vec3d(records_[record].position) - lower_;
    for_each_cell(local, before, level.inverse_cell,
                  [&](Cell c) {
                    const std::size_t at = bucket_of(c, level.buckets.size());
                    level.buckets[at].set_radius(record, radius);
                    level.around[at].set_radius(record, radius);
                  });
  }
  records_[record].radius = radius;
}

template <class Found>
inline bool RecordStore::any_near(std::vector<Bucket> Level::*listed, float least_cosine, Vec3 position, Vec3 normal,
                                  const Found& found) const {
  const Vec3d local = Vec3d(position) - lower_;
  for (const Level& level : levels_) {
    const std::vector<Bucket>& buckets = level.*listed;
    const Bucket& bucket = buckets[bucket_of(cell_at(local, level.inverse_cell), buckets.size())];
    if (bucket.any_near(position, normal, least_cosine, found)) return true;
  }
  return everywhere_.any_near(position, normal, least_cosine, found);
}

void RecordStore::clamp_with_neighbours(IrradianceRecord& record, float slope, std::size_t first) {
  std::vector<std::pair<std::uint32_t, float>> near;
  TEMPOLUX_CHECK(!options_.only_read);
  any_near(&Level::around, options_.least_cosine, record.position, record.normal, [&](const Entry& entry) {
    if (const float d = length(entry.position - record.position);
        d < entry.radius && dot(entry.normal, record.normal) > options_.least_cosine)
      near.emplace_back(entry.record, d);
    return false;
  });
  const auto reach = [](const IrradianceRecord& r) { return std::max(r.radius, r.radius_unclamped); };
  const float own = reach(record);
  for (const auto& [i, d] : near) record.radius = std::min(record.radius, reach(records_[i]) + slope * d);
  for (const auto& [i, d] : near)
    if (i >= first && own + slope * d < records_[i].radius) shrink(i, own + slope * d);
}

inline float RecordStore::weight_of(const Entry& entry, float radius, float least_cosine, Vec3 position, Vec3 normal) {
  const Vec3 d = position - entry.position;
  const float d2 = length2(d);
  if (d2 >= radius * radius) return 0;
  const float cosine = dot(normal, entry.normal);
  if (cosine <= least_cosine) return 0;
  if (std::abs(dot(d, normal + entry.normal)) > 2 * kOffPlane * entry.radius) return 0;
  const float angle = std::sqrt(std::max(0.0f, 1 - cosine) / (1 - least_cosine));
  return std::max(0.0f, (1 - std::sqrt(d2) / radius) * (1 - angle));
}

inline void RecordStore::accumulate(const Entry& entry, float radius, float least_cosine, Vec3 position, Vec3 normal,
                                    Rgb& sum, Interpolated& result) const {
  const float w = weight_of(entry, radius, least_cosine, position, normal);
  if (!(w > 0)) return;
  const IrradianceRecord& r = records_[entry.record];
  const Vec3 d = position - entry.position;
  const Vec3 turn = cross(entry.normal, normal);
  for (int c = 0; c < 3; ++c) {
    const float there = r.irradiance[c] + dot(turn, r.rotational[std::size_t(c)]) + dot(d, r.translational[std::size_t(c)]);
    sum[c] += w * std::max(0.0f, there);
  }
  result.weight += w;
  ++result.count;
}

RecordStore::Interpolated RecordStore::interpolate(Vec3 position, Vec3 normal) const {
  Interpolated result = interpolate(position, normal, options_.least_cosine);
  if (!(result.weight > 0) && options_.least_cosine > kWideCosine) result = interpolate(position, normal, kWideCosine);
  return result;
}

RecordStore::Interpolated RecordStore::interpolate(Vec3 position, Vec3 normal, float least_cosine) const {
  Interpolated result;
  Rgb sum{0.0f};
  any_near(&Level::buckets, least_cosine, position, normal, [&](const Entry& entry) {
    accumulate(entry, entry.radius, least_cosine, position, normal, sum, result);
    return false;
  });
  if (result.weight > 0) result.irradiance = sum * (1 / result.weight);
  return result;
}

float RecordStore::lit_share(Vec3 position, Vec3 normal) const {
  float weights = 0, sum = 0;
  any_near(&Level::buckets, options_.least_cosine, position, normal, [&](const Entry& entry) {
    const float weight = weight_of(entry, entry.radius, options_.least_cosine, position, normal);
    weights += weight;
    sum += weight * records_[entry.record].lit_share;
    return false;
  });
  return weights > 0 ? sum / weights : -1;
}

bool RecordStore::covers(Vec3 position, Vec3 normal, float weight, float least_reach) const {
  const auto covered = [&](float least_cosine, float reach) {
    float sum = 0;
    return any_near(&Level::buckets, least_cosine, position, normal, [&](const Entry& entry) {
      return (sum += weight_of(entry, std::min(entry.radius, reach), least_cosine, position, normal)) >= weight;
    });
  };
  if (covered(options_.least_cosine, INFINITY)) return true;
  return least_reach > 0 && options_.least_cosine > kWideCosine && covered(kWideCosine, least_reach);
}

RecordStore::Interpolated RecordStore::interpolate_relaxed(Vec3 position, Vec3 normal) const {
  Interpolated result;
  Rgb sum{0.0f};
  for (std::uint32_t i = 0; i < records_.size(); ++i)
    accumulate({records_[i].position, records_[i].radius, records_[i].normal, i}, kRelaxed * records_[i].radius,
               options_.least_cosine, position, normal, sum, result);
  if (result.weight > 0) result.irradiance = sum * (1 / result.weight);
  return result;
}

}  // namespace tempolux
