#include "lib/irradcache/points.h"

#include <algorithm>
#include <bit>

#include "formats/photons/photons.h"
#include "lib/core/random.h"

namespace tempolux {
namespace {

constexpr float kSameSide = 0.5f;          ///< cosine between a cell's direction and a point's normal, at least
constexpr int kCandidates = 8;             ///< nearest points among which one of the same object is looked for
constexpr int kMaxProbes = 16;
constexpr std::uint32_t kNormalBins = 8;   ///< per octahedral coordinate
constexpr float kCellsPerSpacing = 1.4f;

std::uint32_t normal_bin(Vec3 n) {
  const auto code = formats::encode_normal({n.x, n.y, n.z});
  return (std::uint32_t(code[0]) * kNormalBins >> 16) * kNormalBins + (std::uint32_t(code[1]) * kNormalBins >> 16);
}

Vec3 bin_direction(std::uint32_t bin) {
  const auto middle = [](std::uint32_t i) { return std::uint16_t((2 * i + 1) * 65536 / (2 * kNormalBins)); };
  const auto n = formats::decode_normal({middle(bin / kNormalBins), middle(bin % kNormalBins)});
  return {n[0], n[1], n[2]};
}

}  // namespace

PointLookup::PointLookup(std::span<const IrradiancePoint> points, const Box3& bounds, float spacing)
    : points_(points), lower_(bounds.lower) {
  std::vector<formats::Photon> as_photons(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    const IrradiancePoint& p = points[i];
    as_photons[i].position = {p.position.x, p.position.y, p.position.z};
    as_photons[i].normal = formats::encode_normal({p.normal.x, p.normal.y, p.normal.z});
    as_photons[i].object = std::uint16_t(p.object);
  }
  index_ = PhotonIndex(as_photons);
  // 2^16 cells per axis at most: they are packed into the key.
  const float extent = bounds.empty() ? 1 : max_component(bounds.upper - bounds.lower);
  cell_ = std::max(spacing / kCellsPerSpacing, extent / 60000);
  inverse_cell_ = 1 / cell_;
  const std::size_t capacity = std::bit_ceil(std::max<std::size_t>(1 << 12, 16 * points.size()));
  mask_ = capacity - 1;
  keys_ = std::make_unique<std::atomic<std::uint64_t>[]>(capacity);
  values_ = std::make_unique<std::atomic<std::uint32_t>[]>(capacity);
}

std::uint32_t PointLookup::search(Vec3 position, Vec3 normal, std::uint32_t object) const {
  thread_local NeighbourList found;
  PhotonQuery query;
  query.point = position;
  query.normal = normal;
  query.min_cos = kSameSide;
  index_.find_nearest(query, kCandidates, found);
  if (found.count() == 0) return 1;
  found.sort_by_distance();
  for (std::uint32_t i : found.photons())
    if (index_.object(i) == std::uint16_t(object)) return index_.source(i) + 2;
  return index_.source(found.photons()[0]) + 2;
}

const IrradiancePoint* PointLookup::find(Vec3 position, Vec3 normal, std::uint32_t object) const {
  const Vec3 local = (position - lower_) * inverse_cell_;
  const auto coordinate = [](float x) { return std::uint64_t(std::clamp(x, 0.0f, 65535.0f)); };
  const std::uint64_t cx = coordinate(local.x), cy = coordinate(local.y), cz = coordinate(local.z);
  const std::uint32_t bin = normal_bin(normal);
  // 16 + 16 + 16 bits of cell, 6 of direction, 10 of object; the rest of the object is in the hash of none:
  // objects whose numbers differ by 1024 share cells only where both are, and then read a near point of either.
  const std::uint64_t key = ((cx << 48 | cy << 32 | cz << 16 | std::uint64_t(bin) << 10 | (object & 1023)) + 1);
  const auto answer = [&](std::uint32_t value) { return value > 1 ? &points_[value - 2] : nullptr; };

  std::size_t slot = mix64(key) & mask_;
  for (int probe = 0; probe < kMaxProbes; ++probe, slot = (slot + 1) & mask_) {
    std::uint64_t there = keys_[slot].load(std::memory_order_acquire);
    if (there == key) {
      const std::uint32_t value = values_[slot].load(std::memory_order_acquire);
      if (value != 0) return answer(value);
    }
    if (there == 0 || there == key) {
      const Vec3 middle = lower_ + Vec3{float(cx) + 0.5f, float(cy) + 0.5f, float(cz) + 0.5f} * cell_;
      const std::uint32_t value = search(middle, bin_direction(bin), object & 1023);
      if (there == 0 && !keys_[slot].compare_exchange_strong(there, key) && there != key) continue;
      values_[slot].store(value, std::memory_order_release);
      return answer(value);
    }
  }
  const Vec3 middle = lower_ + Vec3{float(cx) + 0.5f, float(cy) + 0.5f, float(cz) + 0.5f} * cell_;
  return answer(search(middle, bin_direction(bin), object & 1023));
}

}  // namespace tempolux
