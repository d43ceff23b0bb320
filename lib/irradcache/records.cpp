#include "lib/irradcache/records.h"

#include <algorithm>
#include <cmath>

#include "lib/core/random.h"

namespace tempolux {
namespace {

constexpr int kLevels = 24;
constexpr std::size_t kBuckets = 1 << 14;
constexpr float kBehind = 0.05f;   ///< of the radius: how far behind a record's plane a point may be

}  // namespace

RecordStore::RecordStore(const Box3& bounds, const InterpolationOptions& options)
    : lower_(bounds.lower), largest_cell_(std::max(bounds.diagonal(), 1e-30f)), options_(options), levels_(kLevels) {
  for (int l = 0; l < kLevels; ++l) levels_[std::size_t(l)].cell = std::ldexp(largest_cell_, -l);
}

std::size_t RecordStore::bucket_of(std::int64_t x, std::int64_t y, std::int64_t z, std::size_t mask) {
  const auto u = [](std::int64_t i) { return std::uint64_t(i) & 0x1fffff; };
  return std::size_t(mix64(u(x) << 42 | u(y) << 21 | u(z))) & mask;
}

void RecordStore::add(const IrradianceRecord& record) {
  const auto index = std::uint32_t(records_.size());
  records_.push_back(record);
  // Cells of at least the sphere's diameter: it meets two per axis at most.
  const int wanted = int(std::floor(std::log2(largest_cell_ / std::max(2 * record.radius, 1e-30f))));
  Level& level = levels_[std::size_t(std::clamp(wanted, 0, kLevels - 1))];
  if (level.buckets.empty()) level.buckets.resize(kBuckets);
  const Vec3 low = (record.position - lower_ - Vec3{1, 1, 1} * record.radius) / level.cell;
  const Vec3 high = (record.position - lower_ + Vec3{1, 1, 1} * record.radius) / level.cell;
  const auto cell = [](float x) { return std::int64_t(std::floor(x)); };
  for (std::int64_t x = cell(low.x); x <= cell(high.x); ++x)
    for (std::int64_t y = cell(low.y); y <= cell(high.y); ++y)
      for (std::int64_t z = cell(low.z); z <= cell(high.z); ++z) {
        auto& bucket = level.buckets[bucket_of(x, y, z, kBuckets - 1)];
        if (bucket.empty() || bucket.back() != index) bucket.push_back(index);   // two cells of one hash: once
      }
}

void RecordStore::accumulate(std::uint32_t record, Vec3 position, Vec3 normal, float scale, Rgb& sum,
                             Interpolated& result) const {
  const IrradianceRecord& r = records_[record];
  const float radius = r.radius * scale;
  const Vec3 d = position - r.position;
  const float d2 = length2(d);
  if (d2 >= radius * radius) return;
  const float cosine = dot(normal, r.normal);
  if (cosine <= options_.max_angle_cos) return;
  if (dot(d, normal + r.normal) < -2 * kBehind * r.radius) return;
  const float angle = std::sqrt(std::max(0.0f, 1 - cosine) / (1 - options_.max_angle_cos));
  const float w = (1 - std::sqrt(d2) / radius) * (1 - angle);
  if (!(w > 0)) return;
  const Vec3 turn = cross(r.normal, normal);
  for (int c = 0; c < 3; ++c)
    sum[c] += w * std::max(0.0f, r.irradiance[c] + dot(turn, r.rotational[std::size_t(c)]) + dot(d, r.translational[std::size_t(c)]));
  result.weight += w;
  ++result.count;
}

RecordStore::Interpolated RecordStore::interpolate(Vec3 position, Vec3 normal) const {
  Interpolated result;
  Rgb sum{0.0f};
  for (const Level& level : levels_) {
    if (level.buckets.empty()) continue;
    const Vec3 local = (position - lower_) / level.cell;
    const auto cell = [](float x) { return std::int64_t(std::floor(x)); };
    for (std::uint32_t i : level.buckets[bucket_of(cell(local.x), cell(local.y), cell(local.z), kBuckets - 1)])
      accumulate(i, position, normal, 1, sum, result);
  }
  if (result.weight > 0) result.irradiance = sum * (1 / result.weight);
  return result;
}

RecordStore::Interpolated RecordStore::interpolate_relaxed(Vec3 position, Vec3 normal) const {
  Interpolated result;
  Rgb sum{0.0f};
  std::vector<std::uint32_t> near;
  for (const Level& level : levels_) {
    if (level.buckets.empty()) continue;
    const Vec3 local = (position - lower_) / level.cell;
    const auto cell = [](float x) { return std::int64_t(std::floor(x)); };
    // Cells are two to four radii wide: three radii are within one cell and a half.
    for (std::int64_t x = -1; x <= 1; ++x)
      for (std::int64_t y = -1; y <= 1; ++y)
        for (std::int64_t z = -1; z <= 1; ++z) {
          const auto& bucket = level.buckets[bucket_of(cell(local.x) + x, cell(local.y) + y, cell(local.z) + z, kBuckets - 1)];
          near.insert(near.end(), bucket.begin(), bucket.end());
        }
  }
  std::sort(near.begin(), near.end());
  near.erase(std::unique(near.begin(), near.end()), near.end());
  for (std::uint32_t i : near) accumulate(i, position, normal, kRelaxed, sum, result);
  if (result.weight > 0) result.irradiance = sum * (1 / result.weight);
  return result;
}

}  // namespace tempolux
