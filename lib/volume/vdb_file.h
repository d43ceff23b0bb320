// lib/volume/vdb_file.h -- one density of an OpenVDB file as plain voxels.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "lib/core/affine.h"
#include "lib/volume/voxel_grid.h"

namespace tempolux {

struct VdbVolume {
  std::string grid;                         ///< its name in the file
  std::shared_ptr<const VoxelGrid> voxels;  ///< may be empty: smoke that has not begun
  Affine world_from_index;                  ///< m
};

/// Reads a grid of a .vdb file: `grid` by its name ("NAME:1" is the second of that name); if empty, the grid `density`,
/// else the only grid of floats or doubles. OpenVDB does it in a process of its own (tempolux-vdb) of limited memory
/// and time, so that a hostile file ends in a message. `max_memory` bytes for that process; 0: 400 MB and 64 times the
/// file.
///
/// Throws InputError "FILE: what; remedy" for what cannot be read, is no density (level set, points, vectors), has NaN,
/// infinity or negative values, something other than 0 outside, or a transform that is not affine.
VdbVolume read_vdb(const std::string& path, const std::string& grid, std::uint64_t max_memory);

struct VdbName {
  std::string path, grid;  ///< as for read_vdb
  bool operator==(const VdbName&) const = default;
};

/// The volumes of a range of frames. What comes next is read together with what is asked for, by one process: loading
/// OpenVDB takes 40 ms, more than reading a small file.
class VdbSeries {
 public:
  VdbSeries() = default;
  /// `names`: those that will be asked for, probably in this order.
  explicit VdbSeries(std::vector<VdbName> names) : names_(std::move(names)), ahead_(names_.size()) {}
  /// The same as read_vdb. Trouble with a file that was not asked for yet is not spoken of.
  VdbVolume read(const VdbName& name, std::uint64_t max_memory);

 private:
  void read_together(std::size_t first, std::uint64_t max_memory);
  std::vector<VdbName> names_;
  std::vector<std::optional<VdbVolume>> ahead_;  ///< by name: read and not asked for yet
};

}  // namespace tempolux
