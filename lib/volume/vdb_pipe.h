// lib/volume/vdb_pipe.h -- input and output of the program tempolux-vdb, the only one that links OpenVDB.
//
// Standard input, for each file: its path, a line feed, the grid's name (may be empty), a line feed. Standard output,
// for each file: VdbPipeHead, the bytes of name and note, then a VoxelBlock for each block of 8^3 voxels that is not
// all 0. On failure: one line on standard error and exit code 2; the output of earlier files is complete.
#pragma once

#include <array>
#include <cstdint>

#include "lib/volume/voxel_grid.h"

namespace tempolux {

/// Head of a volume in the output.
struct VdbPipeHead {
  std::array<char, 8> magic{'T', 'P', 'X', 'V', 'D', 'B', '2', '\n'};
  std::array<double, 12> world_from_index{};  ///< three rows of four: x' = r0 x + r1 y + r2 z + r3
  std::uint64_t block_count = 0;
  std::uint64_t name_size = 0;
  std::uint64_t note_size = 0;  ///< bytes of a line that says which values were replaced; 0: none were
};
static_assert(sizeof(VoxelBlock) == 12 + 2048 && sizeof(VdbPipeHead) == 128);

}  // namespace tempolux
