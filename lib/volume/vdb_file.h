// lib/volume/vdb_file.h -- reads one density of an OpenVDB file as plain voxels.
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

/// A density read from a file.
struct VdbVolume {
  std::string grid;                         ///< name in the file
  std::shared_ptr<const VoxelGrid> voxels;  ///< may be empty, since a sequence may begin before its smoke
  Affine world_from_index;                  ///< m
  std::string note;                         ///< which values were replaced; "": none
};

/// Reads the grid named `grid` of a .vdb file ("NAME:1" is the second of that name). If `grid` is empty, reads the grid
/// `density`, or else the only grid of numbers: floats or doubles, or if there are none, integers. A child process
/// (tempolux-vdb) with limited memory and time reads the file, so that a hostile file ends in a message. `max_memory`
/// limits the bytes of that process; 0 means 400 MB plus 64 times the file.
///
/// Values that are negative, NaN or infinite count as 0, with a note, if they are few.
///
/// Throws InputError "FILE: what; remedy" for a file that cannot be read, a grid that is no density (level set, points,
/// vectors), more than a hundredth of invalid values, a background other than 0, or a transform that is not affine.
VdbVolume read_vdb(const std::string& path, const std::string& grid, std::uint64_t max_memory);

/// A grid of a file.
struct VdbName {
  std::string path, grid;  ///< as in read_vdb
  bool operator==(const VdbName&) const = default;
};

/// Reads the volumes of a range of frames. Loading OpenVDB takes 40 ms, longer than reading a small file, so one
/// process reads the requested volume together with the next ones.
class VdbSeries {
 public:
  VdbSeries() = default;
  /// `names` are the volumes that will be requested, probably in this order.
  explicit VdbSeries(std::vector<VdbName> names) : names_(std::move(names)), ahead_(names_.size()) {}
  /// The result of read_vdb(). Errors in files that were read ahead are reported when the file is requested.
  VdbVolume read(const VdbName& name, std::uint64_t max_memory);

 private:
  void read_together(std::size_t first, std::uint64_t max_memory);
  std::vector<VdbName> names_;
  std::vector<std::optional<VdbVolume>> ahead_;  ///< for each name, the volume if it was read but not yet requested
};

}  // namespace tempolux
