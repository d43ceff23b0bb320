// lib/volume/vdb_write.h -- colours on a regular grid as the bytes of an OpenVDB file.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "lib/core/vec.h"

namespace tempolux {

/// A box of voxels, z fastest; values stand for the voxels' centres.
struct ColourGrid {
  std::string name;  ///< of the grid in the file
  std::array<std::int32_t, 3> counts{};
  Vec3d lower, voxel;  ///< m, world space: corner of the box, size of a voxel
  std::vector<Rgb> values;
};

/// The file, made by tempolux-vdb: one grid of vectors of three floats; voxels that are black are left out. Throws
/// InputError if there is no such program, ResourceError if it fails.
std::vector<unsigned char> vdb_file_of(const ColourGrid& grid);

}  // namespace tempolux
