#include "lib/volume/voxel_grid.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <span>
#include <stdexcept>

#include "formats/hash.h"

namespace tempolux {
namespace {

constexpr std::int32_t kFarthest = 1 << 28;  ///< limit of block origins, so that sums of coordinates fit into 32 bits
constexpr const char* kTooFar =
    "its voxels lie too far apart; save its parts as grids of their own and give each as a volume";

std::size_t leaf_offset(int x, int y, int z) { return std::size_t(64 * x + 8 * y + z); }

using BlocksByPlace = std::map<GridIndex, const VoxelBlock*>;

BlocksByPlace by_place(const std::vector<VoxelBlock>& blocks) {
  BlocksByPlace sorted;
  for (const VoxelBlock& block : blocks) {
    for (const std::int32_t o : block.origin)
      if (o % VoxelGrid::kBlock != 0)
        throw std::invalid_argument("a block at " + std::to_string(o) + ", not a multiple of 8");
      else if (o < -kFarthest || o > kFarthest) throw std::invalid_argument(kTooFar);
    float greatest = 0;
    for (const float v : block.values) {
      if (!(v >= 0) || !std::isfinite(v)) throw std::invalid_argument("a value that is negative or not finite");
      greatest = std::max(greatest, v);
    }
    if (greatest > 0 && !sorted.emplace(block.origin, &block).second)
      throw std::invalid_argument("two blocks at one place");
  }
  return sorted;
}

std::string content_hash(const BlocksByPlace& blocks) {
  Hasher hasher;
  for (const auto& [origin, block] : blocks) {
    hasher.add(origin);
    hasher.add_array(std::span<const float>(block->values));
  }
  return hasher.hex();
}

/// Adds the voxels of a block to the largest value and to the support, the box outside which the density is 0.
void measure(const GridIndex& origin, const VoxelBlock& block, float& largest, Box3d& support) {
  constexpr int kBlock = VoxelGrid::kBlock;
  for (int x = 0; x < kBlock; ++x)
    for (int y = 0; y < kBlock; ++y)
      for (int z = 0; z < kBlock; ++z) {
        const float v = block.values[leaf_offset(x, y, z)];
        if (!(v > 0)) continue;
        largest = std::max(largest, v);
        const Vec3d at{double(origin[0] + x), double(origin[1] + y), double(origin[2] + z)};
        support.add(at - Vec3d{1, 1, 1});
        support.add(at + Vec3d{1, 1, 1});
      }
}

}  // namespace

VoxelGrid::VoxelGrid(const std::vector<VoxelBlock>& blocks) {
  const BlocksByPlace sorted = by_place(blocks);
  hash_ = content_hash(sorted);
  if (sorted.empty()) return;
  for (const auto& [origin, block] : sorted) measure(origin, *block, largest_, support_);
  GridIndex first = sorted.begin()->first, last = first;
  for (const auto& [origin, block] : sorted)
    for (std::size_t a = 0; a < 3; ++a) {
      first[a] = std::min(first[a], origin[a]);
      last[a] = std::max(last[a], origin[a]);
    }
  lower_ = first;
  for (std::size_t a = 0; a < 3; ++a) upper_[a] = last[a] + kBlock - 1;
  std::uint64_t count = 1;
  for (std::size_t a = 0; a < 3; ++a) {
    first_block_[a] = first[a] / kBlock - 1;  // the brick of the block before holds the first layer, too
    block_count_[a] = last[a] / kBlock - first_block_[a] + 1;
    count *= std::uint64_t(block_count_[a]);
    if (count > kMostBlocks) throw std::invalid_argument(kTooFar);
  }
  table_.assign(count, kNoBrick);
  const auto entry = [&](const GridIndex& b) -> std::uint32_t& {
    return table_[(std::size_t(b[0] - first_block_[0]) * std::size_t(block_count_[1]) +
                   std::size_t(b[1] - first_block_[1])) *
                      std::size_t(block_count_[2]) +
                  std::size_t(b[2] - first_block_[2])];
  };
  std::uint32_t bricks = 0;
  const auto fill = [&](const GridIndex& origin, const GridIndex& from, const VoxelBlock& block) {
    // Copies the voxels of `block` that lie in the brick of the block at `origin`.
    GridIndex low, high;
    bool any = false;
    for (std::size_t a = 0; a < 3; ++a) {
      low[a] = std::max(origin[a], from[a]);
      high[a] = std::min(origin[a] + kBlock, from[a] + kBlock - 1);
    }
    for (int x = low[0]; x <= high[0]; ++x)
      for (int y = low[1]; y <= high[1]; ++y)
        for (int z = low[2]; z <= high[2]; ++z)
          any |= block.values[leaf_offset(x - from[0], y - from[1], z - from[2])] > 0;
    if (!any) return;
    std::uint32_t& number = entry({origin[0] / kBlock, origin[1] / kBlock, origin[2] / kBlock});
    if (number == kNoBrick) {
      number = bricks++;
      bricks_.resize(std::size_t(bricks) * kBrickSize, 0.0f);
    }
    float* const to = bricks_.data() + std::size_t(number) * kBrickSize;
    for (int x = low[0]; x <= high[0]; ++x)
      for (int y = low[1]; y <= high[1]; ++y)
        for (int z = low[2]; z <= high[2]; ++z)
          to[((x - origin[0]) * kBrick + (y - origin[1])) * kBrick + (z - origin[2])] =
              block.values[leaf_offset(x - from[0], y - from[1], z - from[2])];
  };
  for (const auto& [origin, block] : sorted)
    for (int dx = 0; dx < 2; ++dx)
      for (int dy = 0; dy < 2; ++dy)
        for (int dz = 0; dz < 2; ++dz)
          fill({origin[0] - kBlock * dx, origin[1] - kBlock * dy, origin[2] - kBlock * dz}, origin, *block);
}

std::uint32_t VoxelGrid::brick(std::int32_t x, std::int32_t y, std::int32_t z) const {
  const auto bx = std::uint32_t(x - first_block_[0]), by = std::uint32_t(y - first_block_[1]),
             bz = std::uint32_t(z - first_block_[2]);
  if (bx >= std::uint32_t(block_count_[0]) || by >= std::uint32_t(block_count_[1]) ||
      bz >= std::uint32_t(block_count_[2]))
    return kNoBrick;
  return table_[(std::size_t(bx) * std::size_t(block_count_[1]) + by) * std::size_t(block_count_[2]) + bz];
}

float VoxelGrid::at(Vec3 place) const {
  constexpr auto kFar = float(kFarthest);
  if (!(std::abs(place.x) < kFar && std::abs(place.y) < kFar && std::abs(place.z) < kFar)) return 0;
  const float x = std::floor(place.x), y = std::floor(place.y), z = std::floor(place.z);
  const auto ix = std::int32_t(x), iy = std::int32_t(y), iz = std::int32_t(z);
  const std::uint32_t number = brick(ix >> 3, iy >> 3, iz >> 3);
  if (number == kNoBrick) return 0;
  const float* const v = bricks_.data() + std::size_t(number) * kBrickSize +
                         std::size_t(((ix & 7) * kBrick + (iy & 7)) * kBrick + (iz & 7));
  const float fx = place.x - x, fy = place.y - y, fz = place.z - z;
  const auto along_z = [&](int offset) { return v[offset] + fz * (v[offset + 1] - v[offset]); };
  const auto along_y = [&](int offset) {
    const float low = along_z(offset);
    return low + fy * (along_z(offset + kBrick) - low);
  };
  const float low = along_y(0);
  return std::max(0.0f, low + fx * (along_y(kBrick * kBrick) - low));
}

Box3d VoxelGrid::support() const { return support_; }

float VoxelGrid::largest(const Box3d& box) const {
  if (empty() || box.empty()) return 0;
  GridIndex low, high;
  for (std::size_t a = 0; a < 3; ++a) {
    const int i = int(a);
    low[a] = std::int32_t(std::max<double>(std::floor(std::clamp(box.lower[i], -1e9, 1e9)), lower_[a] - 1));
    high[a] = std::int32_t(std::min<double>(std::ceil(std::clamp(box.upper[i], -1e9, 1e9)), upper_[a] + 1));
    if (low[a] > high[a]) return 0;
  }
  float greatest = 0;
  for (int bx = low[0] >> 3; bx <= high[0] >> 3; ++bx)
    for (int by = low[1] >> 3; by <= high[1] >> 3; ++by)
      for (int bz = low[2] >> 3; bz <= high[2] >> 3; ++bz) {
        const std::uint32_t number = brick(bx, by, bz);
        if (number == kNoBrick) continue;
        const float* const v = bricks_.data() + std::size_t(number) * kBrickSize;
        for (int x = std::max(low[0], bx * kBlock); x <= std::min(high[0], bx * kBlock + 7); ++x)
          for (int y = std::max(low[1], by * kBlock); y <= std::min(high[1], by * kBlock + 7); ++y)
            for (int z = std::max(low[2], bz * kBlock); z <= std::min(high[2], bz * kBlock + 7); ++z)
              greatest = std::max(greatest, v[((x & 7) * kBrick + (y & 7)) * kBrick + (z & 7)]);
      }
  return greatest;
}

std::size_t VoxelGrid::byte_count() const {
  return table_.size() * sizeof(std::uint32_t) + bricks_.size() * sizeof(float);
}

}  // namespace tempolux
