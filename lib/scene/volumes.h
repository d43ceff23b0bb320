// lib/scene/volumes.h -- finds the sequences of density files that a scene or a command line names.
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "lib/scene/at_frame.h"
#include "lib/scene/scene.h"
#include "lib/volume/medium.h"
#include "lib/volume/vdb_file.h"

namespace tempolux {

/// A medium that a scene or command line asks for: one .vdb file per frame, and the optical properties of its density.
struct VolumeSource {
  std::string place;    ///< for messages: an option, or "FILE: node NAME"
  std::string pattern;  ///< file name with ####, %04d or neither; relative to the working folder
  std::string grid;     ///< name; "": the grid `density`, or else the file's only grid of densities
  MediumOptions options;
  std::optional<std::pair<int, int>> frames;  ///< first and last frame with a file; other frames use the closest one
  bool z_up = false;  ///< the file's +z is up and its +y away from the viewer, as in Blender; else +y is up
};

/// The media that nodes of the scene name in their extras, as a JSON object of
///     vdb_pattern           file name with %04d or ####, relative to the scene's folder; without it there is no medium
///     vdb_first, vdb_last   first and last frame with a file (both or none)
///     vdb_grid              name of the grid
///     sigma_t_scale         extinction of density 1, 1/m (default 1)
///     albedo                scattered share: three numbers from 0 to 1, or one (default 1)
///     anisotropy            mean cosine g (default 0)
/// The transform in the .vdb file places the medium in world space [m]; the node's transform has no effect. Throws
/// InputError that names node and key for a wrong type or a value out of range, and for a file name that leaves the
/// scene's folder.
std::vector<VolumeSource> volumes_of(const Scene& scene);

/// Reads files[i] for sources[i] and places the media in scene space (world - origin). Files without voxels and media
/// of no extinction give no medium. `max_memory` limits the bytes of the reading process; 0 derives the limit from the
/// file's size. `series` reads the next files ahead. `notes` gets a line for each file in which values were replaced.
/// Throws InputError as read_vdb() does, and for a medium outside the
/// range of coordinates or of float32.
std::vector<Medium> read_media(std::span<const VolumeSource> sources, std::span<const std::string> files, Vec3d origin,
                               std::uint64_t max_memory, VdbSeries& series, std::vector<std::string>& notes);

/// Why nothing sees a volume, with the place and size of both boxes, for a warning; "": something may see it. Nothing
/// sees a volume that
/// - is farther from the box of the scene's geometry than the diagonal of this box;
/// - or is farther from it than the volume's own diagonal, and outside of all cameras' pictures;
/// - or is below a five hundredth of the picture's height for every camera.
/// Such a volume's transform is usually in centimetres or inches. `volume` and `geometry` are in world space, m, and
/// cameras in scene space, whose origin in world space is `origin`. Empty boxes give "".
std::string why_unseen(const Box3d& volume, const Box3d& geometry, std::span<const PlacedCamera> cameras, Vec3d origin);

}  // namespace tempolux
