#include "lib/irradcache/records.h"

#include <immintrin.h>

#include <algorithm>
#include <bit>
#include <cmath>

#include "lib/irradcache/record_cells.h"

namespace tempolux {
namespace {

bool is_usable(const IrradianceRecord& r) {
  bool finite = is_finite(r.position) && is_finite(r.normal) && std::isfinite(channel_sum(r.irradiance)) &&
                std::isfinite(channel_sum(r.noise));
  for (std::size_t c = 0; c < 3; ++c) finite = finite && is_finite(r.rotational[c]) && is_finite(r.translational[c]);
  return finite && std::isfinite(r.radius) && r.radius > 0;
}

}  // namespace

template <class Found>
inline bool RecordStore::any_of(std::span<const Eight> eights, Vec3 position, Vec3 normal, const Found& found) const {
  constexpr float kSlack = 1e-5f;  // above the rounding errors of this test and of weight_of()
  const auto all = [](float x) { return _mm256_set1_ps(x); };
  const __m256 least = all(least_cosine_ - kSlack), reach = all(1 + kSlack);
  for (const Eight& e : eights) {
    const auto of = [](const float* lanes) { return _mm256_load_ps(lanes); };
    const __m256 dx = all(position.x) - of(e.x), dy = all(position.y) - of(e.y), dz = all(position.z) - of(e.z),
                 r = of(e.radius);
    const __m256 cosine =
        all(normal.x) * of(e.normal_x) + all(normal.y) * of(e.normal_y) + all(normal.z) * of(e.normal_z);
    const __m256 near = _mm256_cmp_ps(dx * dx + dy * dy + dz * dz, r * r * reach, _CMP_LT_OQ);
    const __m256 counts = _mm256_and_ps(near, _mm256_cmp_ps(cosine, least, _CMP_GT_OQ));
    if (_mm256_testz_ps(counts, counts)) continue;
    // |d . (n + n_i)| as a square: |x| <= a if x^2 <= a^2
    const __m256 off = dx * (all(normal.x) + of(e.normal_x)) + dy * (all(normal.y) + of(e.normal_y)) +
                       dz * (all(normal.z) + of(e.normal_z)),
                 most = r * all(2 * Clearance::kOffPlane + kSlack);
    for (int lanes = _mm256_movemask_ps(_mm256_and_ps(counts, _mm256_cmp_ps(off * off, most * most, _CMP_LE_OQ)));
         lanes; lanes &= lanes - 1) {
      const auto i = std::size_t(std::countr_zero(unsigned(lanes)));
      if (found(
              Entry{{e.x[i], e.y[i], e.z[i]}, e.radius[i], {e.normal_x[i], e.normal_y[i], e.normal_z[i]}, e.record[i]}))
        return true;
    }
  }
  return false;
}

/// The level whose cells are one to two radii wide.
RecordStore::Level& RecordStore::level_of(float radius) {
  const int exponent = std::ilogb(radius) + 1;
  for (Level& level : levels_)
    if (level.exponent == exponent) return level;
  Level& level = levels_.emplace_back();
  level.exponent = exponent;
  level.inverse_cell = std::ldexp(1.0, -exponent);
  level.buckets.resize(kFirstBuckets);
  return level;
}

bool RecordStore::add(const IrradianceRecord& record) {
  if (!is_usable(record)) {
    ++refused_;
    return false;
  }
  Level& level = level_of(record.radius);
  level.members.push_back(std::uint32_t(records_.size()));
  records_.push_back(record);
  if (level.listed < 4 * level.buckets.size()) {
    list(level, level.members.back());
    return true;
  }
  level.buckets.assign(4 * level.buckets.size(), {});
  level.listed = 0;
  for (std::uint32_t member : level.members) list(level, member);
  return true;
}

/// The record stays on its level and in its cells.
void RecordStore::shrink(std::uint32_t record, float radius) {
  for (Level& level : levels_) {
    if (!std::binary_search(level.members.begin(), level.members.end(), record)) continue;
    for_each_cell(Vec3d(records_[record].position), records_[record].radius, level.inverse_cell,
                  [&](Cell c) { level.buckets[bucket_of(c, level.buckets.size())].set_radius(record, radius); });
  }
  records_[record].radius = radius;
}

template <class Found>
inline bool RecordStore::any_near(Vec3 position, Vec3 normal, const Found& found) const {
  const Vec3d local(position);
  return std::ranges::any_of(levels_, [&](const Level& level) {
    const Bucket& bucket = level.buckets[bucket_of(cell_at(local, level.inverse_cell), level.buckets.size())];
    return any_of(bucket.eights(), position, normal, found);
  });
}

inline float RecordStore::weight_of(const Entry& entry, Vec3 position, Vec3 normal) const {
  const Vec3 d = position - entry.position;
  const float d2 = length2(d);
  if (d2 >= entry.radius * entry.radius) return 0;
  const float cosine = dot(normal, entry.normal);
  if (cosine <= least_cosine_) return 0;
  if (std::abs(dot(d, normal + entry.normal)) > 2 * Clearance::kOffPlane * entry.radius) return 0;
  const float angle = std::sqrt(std::max(0.0f, 1 - cosine) / (1 - least_cosine_));
  const float weight = std::max(0.0f, (1 - std::sqrt(d2) / entry.radius) * (1 - angle));
  if (!(weight > 0)) return 0;
  const Clearance& seen = records_[entry.record].clearance;
  return seen.contains(d, entry.normal) ? weight : 0;
}

/// Weight of a valid record at a place whose own radius is at most `place_radius` (interpolate()). `distance` [m]: of
/// the place from the record.
inline float RecordStore::agreeing(float weight, float radius, float distance, float place_radius) {
  const float most = place_radius + distance;
  if (!(radius > most)) return weight;
  const float less = 2 * most - radius;
  return less > distance ? weight * (1 - distance / less) / (1 - distance / radius) : 0;
}

RecordStore::Interpolated RecordStore::interpolate(Vec3 position, Vec3 normal) const {
  struct Valid {
    std::uint32_t record;
    float weight, radius, distance;
  };
  thread_local std::vector<Valid> all;
  all.clear();
  float place_radius = INFINITY, largest = 0;
  any_near(position, normal, [&](const Entry& entry) {
    const float w = weight_of(entry, position, normal);
    if (!(w > 0)) return false;
    const float distance = length(position - entry.position);
    all.push_back({entry.record, w, entry.radius, distance});
    place_radius = std::min(place_radius, entry.radius + distance);
    largest = std::max(largest, entry.radius - distance);
    return false;
  });
  Interpolated result;
  Rgb sum{0.0f};
  for (const Valid& valid : all) {
    const float w =
        largest > place_radius ? agreeing(valid.weight, valid.radius, valid.distance, place_radius) : valid.weight;
    if (!(w > 0)) continue;
    const IrradianceRecord& r = records_[valid.record];
    const Vec3 d = position - r.position, turn = cross(r.normal, normal);
    for (int c = 0; c < 3; ++c) {
      const float there =
          r.irradiance[c] + dot(turn, r.rotational[std::size_t(c)]) + dot(d, r.translational[std::size_t(c)]);
      sum[c] += w * std::max(0.0f, there);
    }
    result.noise += w * r.noise;
    result.weight += w;
    ++result.count;
  }
  if (result.weight > 0) {
    result.irradiance = sum * (1 / result.weight);
    result.noise *= 1 / result.weight;
  }
  return result;
}

float RecordStore::weight_of_earlier(std::uint32_t record, std::span<const std::uint8_t> marked) const {
  const Vec3 position = records_[record].position, normal = records_[record].normal;
  float sum = 0;
  any_near(position, normal, [&](const Entry& entry) {
    if (entry.record < record && (marked.empty() || !marked[entry.record])) sum += weight_of(entry, position, normal);
    return false;
  });
  return sum;
}

bool RecordStore::covers(Vec3 position, Vec3 normal, float weight) const {
  float sum = 0;
  return any_near(position, normal,
                  [&](const Entry& entry) { return (sum += weight_of(entry, position, normal)) >= weight; });
}

void RecordStore::for_each_valid(Vec3 position, Vec3 normal, const std::function<void(std::uint32_t)>& found) const {
  any_near(position, normal, [&](const Entry& entry) {
    if (weight_of(entry, position, normal) > 0) found(entry.record);
    return false;
  });
}

void RecordStore::complete_noise(std::size_t first, float factor) {
  for (std::size_t i = first; i < records_.size(); ++i)
    records_[i].noise = records_[i].noise * factor + records_[i].points_noise;
}

std::optional<Rgb> RecordStore::irradiance(Vec3 position, Vec3 normal) const {
  const Interpolated found = interpolate(position, normal);
  return found.weight > 0 ? std::optional(found.irradiance) : std::nullopt;
}

}  // namespace tempolux
