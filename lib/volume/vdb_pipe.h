// lib/volume/vdb_pipe.h -- what tempolux-vdb, which alone links OpenVDB, is asked and what it prints.
//
// Asked on standard input, for each file: its path, a line feed, the grid's name (may be empty), a line feed.
// Printed, for each: VdbPipeHead, the name's bytes, then a VoxelBlock for each block of 8^3 voxels that is not all 0.
// In trouble: one line on standard error and exit code 2; what it read before has been printed.
#pragma once

#include <array>
#include <cstdint>

#include "lib/volume/voxel_grid.h"

namespace tempolux {

struct VdbPipeHead {
  std::array<char, 8> magic{'T', 'P', 'X', 'V', 'D', 'B', '1', '\n'};
  std::array<double, 12> world_from_index{};  ///< three rows of four: x' = r0 x + r1 y + r2 z + r3
  std::uint64_t block_count = 0;
  std::uint64_t name_size = 0;
};
/// With the argument `write` it makes a file instead: it is given this, the grid's name, and counts[0] x counts[1] x
/// counts[2] colours of three float32, z fastest, and prints the file.
struct VdbWriteHead {
  std::array<char, 8> magic{'T', 'P', 'X', 'V', 'D', 'B', 'W', '\n'};
  std::array<double, 3> voxel{}, first_centre{};  ///< m: edges of a voxel, centre of the first
  std::array<std::int32_t, 3> counts{};
  std::uint32_t reserved = 0;
  std::uint64_t name_size = 0;
};

static_assert(sizeof(VdbWriteHead) == 80);
static_assert(sizeof(VoxelBlock) == 12 + 2048 && sizeof(VdbPipeHead) == 120);

}  // namespace tempolux
