#include "lib/light/light_grid.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "lib/core/check.h"
#include "lib/core/random.h"

namespace tempolux {
namespace {

constexpr int kBits = 20;                                       ///< bits of one coordinate in a key
constexpr std::int64_t kHalf = std::int64_t(1) << (kBits - 1);  ///< cells on either side of the origin
constexpr std::uint64_t kMask = (std::uint64_t(1) << kBits) - 1;

/// 0 to 5: the axis of the normal's largest component (x, y, z) and its sign.
std::uint64_t facing(Vec3 n) {
  const float x = std::abs(n.x), y = std::abs(n.y), z = std::abs(n.z);
  if (x >= y && x >= z) return n.x < 0;
  return y >= z ? 2 + (n.y < 0) : 4 + (n.z < 0);
}

}  // namespace

LightGrid::LightGrid(float edge, const Environment* environment) : edge_(edge) {
  TEMPOLUX_CHECK(edge > 0);
  if (environment) sky_ = std::make_unique<EnvironmentLight>(*environment, 1);
}

std::uint64_t LightGrid::key_of(const Place& place) {
  std::uint64_t key = 1;
  for (const std::int32_t x : place.at) key = key << kBits | std::uint64_t(x + kHalf);
  return key * 6 + place.facing;
}

LightGrid::Place LightGrid::place_of(std::uint64_t key) {
  Place place;
  place.facing = std::uint32_t(key % 6);
  for (int axis = 0; axis < 3; ++axis)
    place.at[std::size_t(axis)] = std::int32_t(std::int64_t(key / 6 >> (kBits * (2 - axis)) & kMask) - kHalf);
  return place;
}

std::uint64_t LightGrid::key(Vec3 position, Vec3 normal) const {
  Place place;
  place.facing = std::uint32_t(facing(normal));
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double cell = std::floor(double((&position.x)[axis]) / double(edge_));
    if (!(std::abs(cell) <= double(kFarthest))) return 0;
    place.at[axis] = std::int32_t(cell);
  }
  return key_of(place);
}

std::uint64_t LightGrid::beside(std::uint64_t key, int axis, int steps) {
  const std::uint64_t unit = std::uint64_t(6) << (kBits * (2 - axis));
  return steps < 0 ? key - unit * std::uint64_t(-steps) : key + unit * std::uint64_t(steps);
}

void LightGrid::set(std::vector<std::uint64_t> keys, std::vector<Cell> cells) {
  TEMPOLUX_CHECK(keys.size() == cells.size() && std::is_sorted(keys.begin(), keys.end()));
  keys_ = std::move(keys);
  cells_ = std::move(cells);
  table_.assign(std::bit_ceil(2 * keys_.size() + 2), 0);
  mask_ = table_.size() - 1;
  for (std::size_t i = 0; i < keys_.size(); ++i) {
    std::size_t at = mix64(keys_[i]) & mask_;
    while (table_[at]) at = (at + 1) & mask_;
    table_[at] = std::uint32_t(i + 1);
  }
}

const LightGrid::Cell* LightGrid::find(Vec3 position, Vec3 normal) const {
  if (normal == Vec3{} || table_.empty()) return nullptr;
  const std::uint64_t wanted = key(position, normal);
  for (std::size_t at = mix64(wanted) & mask_; table_[at]; at = (at + 1) & mask_)
    if (keys_[table_[at] - 1] == wanted) return &cells_[table_[at] - 1];
  return nullptr;
}

bool LightGrid::sample_sky(const Cell& cell, float u, float u2, EnvironmentLight::Sample& sample,
                           double& density) const {
  if (!sky_) return false;
  const auto part = std::uint32_t(
      std::min<std::ptrdiff_t>(std::upper_bound(cell.end.begin(), cell.end.end(), u) - cell.end.begin(), kParts - 1));
  const double first = part > 0 ? double(cell.end[part - 1]) : 0, share = double(cell.end[part]) - first;
  if (!(share > 0)) return false;
  const double across = std::clamp((double(u) - first) / share, 0.0, 1 - 0x1p-53);
  if (!sky_->sample((part / kAcross + across) / kDown, std::min((part % kAcross + double(u2)) / kAcross, 1 - 0x1p-53),
                    sample))
    return false;
  density = sample.pdf_solid_angle * share * kParts;
  return density > 0;
}

std::uint32_t LightGrid::part_of(Vec3 direction) const {
  const Vec2 u = sky_->numbers_of(direction);
  return std::min(std::uint32_t(u.x * kDown), kDown - 1) * kAcross +
         std::min(std::uint32_t(u.y * kAcross), kAcross - 1);
}

double LightGrid::sky_density(const Cell& cell, Vec3 direction) const {
  if (!sky_) return 0;
  const std::uint32_t part = part_of(direction);
  const double share = double(cell.end[part]) - (part > 0 ? double(cell.end[part - 1]) : 0);
  return share * kParts * sky_->pdf_solid_angle(direction);
}

}  // namespace tempolux
