// lib/volume/vdb_file.h -- one density of an OpenVDB file as plain voxels.
#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "lib/core/affine.h"
#include "lib/volume/voxel_grid.h"

namespace tempolux {

struct VdbVolume {
  std::string grid;                          ///< its name in the file
  std::shared_ptr<const VoxelGrid> voxels;   ///< may be empty: smoke that has not begun
  Affine world_from_index;                   ///< m
};

/// Reads a grid of a .vdb file: `grid` by its name ("NAME:1" is the second of that name); if empty, the grid `density`, else the
/// only grid of floats or doubles. OpenVDB does it in a process of its own (tempolux-vdb) of limited memory and time, so that a
/// hostile file ends in a message. `max_memory` bytes for that process; 0: 400 MB and 64 times the file.
///
/// Throws InputError "FILE: what; remedy" for what cannot be read, is no density (level set, points, vectors), has NaN, infinity or
/// negative values, something other than 0 outside, or a transform that is not affine.
VdbVolume read_vdb(const std::string& path, const std::string& grid, std::uint64_t max_memory);

}  // namespace tempolux
