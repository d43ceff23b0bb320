// lib/scene/volumes.h -- finds the sequences of density files that a scene or a command line names.
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

/// A medium as requested: one .vdb file per frame, and the optical properties of its density.
struct VolumeSource {
  std::string place;    ///< for messages: an option, or "FILE: node NAME"
  std::string pattern;  ///< file name with ####, %04d or neither; relative to the working folder
  std::string grid;     ///< "": the grid `density`, else the only grid that can be meant
  MediumOptions options;
  std::optional<std::pair<int, int>> frames;  ///< first and last frame with a file; other frames use the nearest one
};

/// The media that nodes of the scene name in their extras, as a JSON object of
///     vdb_pattern           file name with %04d or ####, relative to the scene's folder; without it there is no medium
///     vdb_first, vdb_last   first and last frame with a file (both or none)
///     vdb_grid              name of the grid
///     sigma_t_scale         extinction of density 1, 1/m (default 1)
///     albedo                scattered share: three numbers from 0 to 1, or one (default 1)
///     anisotropy            mean cosine g (default 0)
/// The transform in the .vdb file places the medium, in metres of world space; the node's transform has no effect.
/// Throws InputError naming node and key for a wrong type or a value out of range, and for a file name that leaves the
/// scene's folder.
std::vector<VolumeSource> volumes_of(const Scene& scene);

/// Reads `files[i]` for sources[i] and places the media in scene space (world - origin). `max_memory`: bytes that the
/// reading process may use; 0: by the file's size. `series` prefetches the next files. Throws InputError as read_vdb
/// does.
std::vector<Medium> read_media(std::span<const VolumeSource> sources, std::span<const std::string> files, Vec3d origin,
                               std::uint64_t max_memory, VdbSeries& series);

}  // namespace tempolux
