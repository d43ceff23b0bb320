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

RecordStore::Interpolated RecordStore::interpolate(Vec3 position, Vec3 normal) const {
  Interpolated result;
  Rgb sum{0.0f};
  const float angle_scale = 1 / (1 - options_.max_angle_cos);
  for (const Level& level : levels_) {
    if (level.buckets.empty()) continue;
    const Vec3 local = (position - lower_) / level.cell;
    const auto cell = [](float x) { return std::int64_t(std::floor(x)); };
    for (std::uint32_t i : level.buckets[bucket_of(cell(local.x), cell(local.y), cell(local.z), kBuckets - 1)]) {
      const IrradianceRecord& r = records_[i];
      const Vec3 d = position - r.position;
      const float d2 = length2(d);
      if (d2 >= r.radius * r.radius) continue;
      const float cosine = dot(normal, r.normal);
      if (cosine <= options_.max_angle_cos) continue;
      if (dot(d, normal + r.normal) < -2 * kBehind * r.radius) continue;
      const float w = (1 - std::sqrt(d2) / r.radius) * (1 - std::sqrt(std::max(0.0f, 1 - cosine) * angle_scale));
      if (!(w > 0)) continue;
      const Vec3 turn = cross(r.normal, normal);
      for (int c = 0; c < 3; ++c)
        sum[c] += w * std::max(0.0f, r.irradiance[c] + dot(turn, r.rotational[std::size_t(c)]) + dot(d, r.translational[std::size_t(c)]));
      result.weight += w;
      ++result.count;
    }
  }
  if (result.weight > 0) result.irradiance = sum * (1 / result.weight);
  return result;
}

}  // namespace tempolux
