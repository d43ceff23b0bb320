// lib/volume/vdb_write.h -- writes colours on a regular grid as an OpenVDB file.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "lib/core/vec.h"

namespace tempolux {

/// Colours at the centres of a box of voxels, z fastest.
struct ColourGrid {
  std::string name;  ///< of the grid in the file
  std::array<std::int32_t, 3> counts{};
  Vec3d lower, voxel;  ///< m, world space: lower corner of the box, size of a voxel
  std::vector<Rgb> values;
};

/// The bytes of the file, written by tempolux-vdb: one grid of vectors of three floats; black voxels are left out.
/// Throws InputError if the program is missing, ResourceError if it fails.
std::vector<unsigned char> vdb_file_of(const ColourGrid& grid);

}  // namespace tempolux
