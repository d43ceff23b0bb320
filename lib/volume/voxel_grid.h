// lib/volume/voxel_grid.h -- values at integer coordinates of a grid, interpolated trilinearly.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "lib/core/vec.h"

namespace tempolux {

/// Integer coordinates of a voxel, or of a block.
using GridIndex = std::array<std::int32_t, 3>;

/// 8^3 voxels as OpenVDB's leaves have them: the value of voxel origin + (x, y, z) is values[64 x + 8 y + z].
struct VoxelBlock {
  GridIndex origin{};  ///< multiples of 8
  std::array<float, 512> values{};
};

/// Values >= 0 at integer coordinates of index space; 0 outside all blocks. Between integer coordinates values are
/// trilinear, as in OpenVDB's BoxSampler and in Cycles: half-way between two voxels the value is their mean.
///
/// A block of zeros costs four bytes. A brick is a stored block with the first layers of its neighbours, 9^3 values, so
/// that the eight values of a look-up lie in one array.
class VoxelGrid {
 public:
  static constexpr int kBlock = 8;
  /// Largest number of entries in the table of blocks, empty ones included: 256 MB.
  static constexpr std::uint64_t kMostBlocks = std::uint64_t(1) << 26;

  VoxelGrid() = default;
  /// Blocks may be in any order. Throws std::invalid_argument for an origin that is not a multiple of 8 or beyond 2^28,
  /// a value that is negative or not finite, two blocks with one origin, or more than kMostBlocks in the bounding box.
  explicit VoxelGrid(const std::vector<VoxelBlock>& blocks);

  bool empty() const { return bricks_.empty(); }
  /// Value at a position of index space.
  float at(Vec3 place) const;
  /// Index-space box outside which at() is 0: from one before the first voxel above 0 to one after the last.
  Box3d support() const;
  /// Largest value of at() in a closed box of index space. Visits each voxel of the box.
  float largest(const Box3d& box) const;
  float largest() const { return largest_; }  ///< largest voxel
  std::size_t byte_count() const;
  /// Hash of all blocks that are not 0, with their origins.
  const std::string& hash() const { return hash_; }

 private:
  static constexpr int kBrick = kBlock + 1;
  static constexpr std::size_t kBrickSize = std::size_t(kBrick) * kBrick * kBrick;
  static constexpr std::uint32_t kNoBrick = 0xffffffffu;
  /// Number of the brick that holds block (x, y, z), or kNoBrick.
  std::uint32_t brick(std::int32_t x, std::int32_t y, std::int32_t z) const;

  GridIndex first_block_{}, block_count_{};
  std::vector<std::uint32_t> table_;  ///< number of each block's brick; z varies fastest
  std::vector<float> bricks_;         ///< kBrickSize values for each brick; z varies fastest
  /// Smallest and largest index (inclusive) of a voxel in a stored block; lower_ > upper_ if there is none.
  GridIndex lower_{1, 1, 1}, upper_{0, 0, 0};
  Box3d support_;
  float largest_ = 0;
  std::string hash_;
};

}  // namespace tempolux
