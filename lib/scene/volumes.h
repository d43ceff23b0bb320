// lib/scene/volumes.h -- sequences of density files as a scene or a command line names them.
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "lib/scene/scene.h"
#include "lib/volume/medium.h"
#include "lib/volume/vdb_file.h"

namespace tempolux {

/// A medium as it is asked for: one .vdb file for each frame, and what its density does to light.
struct VolumeSource {
  std::string place;    ///< for messages: an option, or "FILE: node NAME"
  std::string pattern;  ///< name with ####, %04d or neither; relative to the working folder
  std::string grid;     ///< "": the grid density, else the only one that could be meant
  MediumOptions options;
  std::optional<std::pair<int, int>> frames;  ///< first and last file; before and behind them these two are shown
};

/// The media that nodes of the scene name in their extras, as a JSON object of
///     vdb_pattern        file name with %04d or ####, relative to the scene's folder; without it the node names no
///     medium vdb_first, vdb_last  frames that have a file (both or none) vdb_grid           name of the grid
///     sigma_t_scale      extinction of density 1, 1/m (1)
///     albedo             share that is scattered: three numbers from 0 to 1, or one (1)
///     anisotropy         mean cosine g (0)
/// The transform in the file places it, in metres of world space; that of the node does not.
/// Throws InputError naming node and key for what is of another type or out of range, and for a file name that leaves
/// the scene's folder unless `allow_outside`.
std::vector<VolumeSource> volumes_of(const Scene& scene, bool allow_outside);

/// Reads `files[i]` for sources[i] and places them in scene space (world - origin). `max_memory`: of the reading
/// process, bytes; 0: by the file's size. `series` knows what is read next. Throws InputError as read_vdb does.
std::vector<Medium> read_media(std::span<const VolumeSource> sources, std::span<const std::string> files, Vec3d origin,
                               std::uint64_t max_memory, VdbSeries& series);

}  // namespace tempolux
