#include "lib/gather/facing_grid.h"

#include <algorithm>
#include <atomic>
#include <bit>
#include <cmath>

#include "lib/core/parallel.h"
#include "lib/scene/at_frame.h"

namespace tempolux {
namespace {

constexpr float kMostCells = 40;  ///< along the longest side
constexpr std::size_t kChunk = 1 << 14;
constexpr float kSlack = 0.01f;   ///< rad: photons' normals are kept to 1e-3 per component

Vec3 decode(std::uint32_t u, std::uint32_t v, std::uint32_t steps) {
  const auto code = [steps](std::uint32_t i) { return std::uint16_t(std::min(65534u, i * 65535u / steps)); };
  const auto n = formats::decode_normal({code(u), code(v)});
  return {n[0], n[1], n[2]};
}

}  // namespace

std::uint32_t FacingGrid::bin_of(Vec3 normal) {
  const auto code = formats::encode_normal({normal.x, normal.y, normal.z});
  return (code[0] * kBins / 65535u) * kBins + code[1] * kBins / 65535u;
}

FacingGrid::FacingGrid(const PhotonIndex& photons, float max_radius) {
  if (photons.size() == 0) return;
  Box3 bounds;
  for (std::size_t i = 0; i < photons.size(); ++i) bounds.add(photons.position(i));
  const Vec3 extent = bounds.upper - bounds.lower;
  const float cell = std::max({1.001f * max_radius, max_component(extent) / kMostCells, 1e-30f});
  inverse_cell_ = 1 / cell;
  lower_ = bounds.lower - Vec3{cell, cell, cell};
  for (std::size_t a = 0; a < 3; ++a) size_[a] = std::size_t(extent[int(a)] * inverse_cell_) + 3;
  cells_.assign(size_[0] * size_[1] * size_[2], Directions{});

  float widest = 0;
  for (std::uint32_t u = 0; u < kBins; ++u)
    for (std::uint32_t v = 0; v < kBins; ++v) {
      const Vec3 middle = decode(2 * u + 1, 2 * v + 1, 2 * kBins);
      bin_middle_.push_back(middle);
      for (std::uint32_t corner = 0; corner < 4; ++corner)
        widest = std::max(
            widest, std::acos(std::clamp(dot(middle, decode(u + (corner & 1), v + (corner >> 1), kBins)),
                                         -1.0f, 1.0f)));
    }
  bin_sine_ = std::sin(widest + kSlack);
  bin_cosine_ = std::cos(widest + kSlack);

  parallel_chunks(photons.size(), kChunk, [&](std::size_t first, std::size_t last) {
    for (std::size_t i = first; i < last; ++i) {
      const Vec3 at = (photons.position(i) - lower_) * inverse_cell_;
      const std::size_t place = (std::size_t(at.z) * size_[1] + std::size_t(at.y)) * size_[0] + std::size_t(at.x);
      const std::uint32_t bin = bin_of(photons.normal(i));
      const std::uint64_t bit = std::uint64_t(1) << bin % 64;
      const std::atomic_ref<std::uint64_t> word(cells_[place][bin / 64]);   // bits have no order
      if (!(word.load(std::memory_order_relaxed) & bit)) word.fetch_or(bit, std::memory_order_relaxed);
    }
  });
  spread(1, size_[0]);
  spread(size_[0], size_[1]);
  spread(size_[0] * size_[1], size_[2]);
}

/// Adds to each cell what its two neighbours along one axis know.
void FacingGrid::spread(std::size_t stride, std::size_t count) {
  const std::vector<Directions> before = cells_;
  for (std::size_t i = 0; i < cells_.size(); ++i) {
    const std::size_t along = i / stride % count;
    for (std::size_t word = 0; word < before[i].size(); ++word) {
      if (along > 0) cells_[i][word] |= before[i - stride][word];
      if (along + 1 < count) cells_[i][word] |= before[i + stride][word];
    }
  }
}

bool FacingGrid::any_near(Vec3 point, Vec3 normal, float min_cos) const {
  if (cells_.empty()) return false;
  const Vec3 at = (point - lower_) * inverse_cell_;
  for (int a = 0; a < 3; ++a)
    if (!(at[a] >= 0) || !(at[a] < float(size_[std::size_t(a)]))) return false;
  const Directions& directions =
      cells_[(std::size_t(at.z) * size_[1] + std::size_t(at.y)) * size_[0] + std::size_t(at.x)];
  // Within a bin the cosine reaches cos(angle to its middle - half its width): compare the middle's with the
  // cosine of acos(min_cos) + half the width.
  const float least = min_cos * bin_cosine_ - std::sqrt(std::max(0.0f, 1 - min_cos * min_cos)) * bin_sine_;
  for (std::size_t word = 0; word < directions.size(); ++word)
    for (std::uint64_t bits = directions[word]; bits; bits &= bits - 1)
      if (dot(bin_middle_[64 * word + std::size_t(std::countr_zero(bits))], normal) > least) return true;
  return false;
}

}  // namespace tempolux
