#include "lib/gather/localised.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <optional>

#include "lib/core/parallel_each.h"

namespace tempolux {
namespace {

/// As a divisor, irradiance counts as at least this share of the records' mean. If the mean is shown as 18 % grey,
/// light of 1 % of the mean has 6 codes in sRGB, and a change of it by `low`, 6 %, is a third of a code.
constexpr float kLeastShare = 0.01f;

/// A record counts as influenced above this share of the lower threshold. The remaining .1 % is more than the rounding
/// errors of sums of floats.
constexpr float kBelow = 0.999f;

/// The smallest normal number: tools count denormal numbers as 0, so a smaller weight would be no weight.
constexpr float kAnyWeight = std::numeric_limits<float>::min();

/// Radius of the disc of dynamic photons, over the radius of the disc of k static photons. With k = 50 and an influence
/// of .06, the lower threshold, the wide disc holds .06 x 50 x 7^2 = 150 dynamic photons. Their standard deviation is
/// sqrt(150) / (50 x 7^2) = .5 % of the static light, about the noise of gather rays. The narrow disc would hold 3
/// photons with a standard deviation of 3.5 %, which a viewer sees as flicker (docs/methods/dynamic.md).
constexpr float kWider = 7;

PathRandom random_at(Vec3 p, std::uint64_t seed) {
  std::uint64_t key = seed;
  for (const float x : {p.x, p.y, p.z}) key = mix64(key ^ std::bit_cast<std::uint32_t>(x));
  return PathRandom(seed, key);
}

}  // namespace

float InfluenceThresholds::gathered_share(float influence) const {
  if (!(influence > low)) return 0;
  if (!(influence < high)) return 1;
  const float t = (influence - low) / (high - low);
  return t * t * (3 - 2 * t);
}

std::vector<RecordChange> record_changes(std::span<const IrradianceRecord> records, std::span<const SignedDensity> maps,
                                         const PointLookup& points, std::uint64_t seed) {
  std::vector<RecordChange> changes(records.size());
  parallel_each(records.size(), 256, [&](std::size_t i) {
    const IrradianceRecord& record = records[i];
    changes[i].updated_irradiance = record.irradiance;
    const PointLookup::Light* point = points.nearest(record.position, record.normal);
    const float radius = point ? kWider * points.point(*point).radius : 0;
    const PathRandom random = random_at(record.position, seed);
    SignedDensity::Area area;
    for (std::size_t m = 0; m < maps.size(); ++m) {
      if (m > 0 && !(maps[m].most_influence(record.position, record.normal, radius, random, area) >
                     double(changes[i].influence)))
        continue;
      const auto change = maps[m].at(record.position, record.normal, radius, random, area);
      if (!change) continue;
      changes[i].influence = std::max(changes[i].influence, float(change->influence));
      if (m == 0) changes[i].updated_irradiance = Rgb(Rgbd(record.irradiance) + change->irradiance);
    }
  });
  return changes;
}

InfluenceField::InfluenceField(std::span<const IrradianceRecord> records, std::span<const RecordChange> changes,
                               const InfluenceThresholds& thresholds)
    : store_(0), influenced_(0), thresholds_(thresholds) {
  std::vector<IrradianceRecord> pairs;
  double sum = 0;
  for (std::size_t i = 0; i < records.size(); ++i) {
    IrradianceRecord pair;
    pair.position = records[i].position;
    pair.normal = records[i].normal;
    pair.radius = records[i].radius;
    pair.radius_unclamped = records[i].radius_unclamped;
    pair.object = records[i].object;
    pair.clearance = records[i].clearance;
    pair.irradiance = {changes[i].influence, max_component(records[i].irradiance), 0};
    sum += double(pair.irradiance.g);
    pairs.push_back(pair);
    if (!(pair.irradiance.r <= kBelow * thresholds_.low * pair.irradiance.g)) influenced_.add(pair);
  }
  if (!records.empty()) least_ = kLeastShare * float(sum / double(records.size()));
  store_.add(pairs);
}

float InfluenceField::relative(Rgb pair) const {
  if (!(pair.r > 0)) return pair.r;
  return pair.r / std::max({pair.g, least_, 1e-30f});
}

bool InfluenceField::near_influenced(Vec3 position, Vec3 normal) const {
  return influenced_.covers(position, normal, kAnyWeight);
}

float InfluenceField::gathered_share(Vec3 position, Vec3 normal) const {
  if (!near_influenced(position, normal) && store_.covers(position, normal, kAnyWeight)) return 0;
  return thresholds_.gathered_share(at(position, normal));
}

float InfluenceField::at(Vec3 position, Vec3 normal) const {
  const std::optional<Rgb> found = store_.irradiance(position, normal);
  return found ? relative(*found) : INFINITY;
}

}  // namespace tempolux
