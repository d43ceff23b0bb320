// lib/temporal/kept_files.h -- writes the .radsamples files of a range of frames as whole files and overlays, reads the
// file of an earlier frame, and checks that the frame can follow from it (formats/radsamples/radsamples.md).
#pragma once

#include <array>
#include <functional>
#include <string>
#include <unordered_map>
#include <vector>

#include "lib/points/gather_points.h"
#include "lib/scene/at_frame.h"
#include "lib/temporal/kept_hemisphere.h"

namespace tempolux {

/// The points of a frame, with the hashes that kept samples must have been gathered from.
struct FramePoints : DividedGatherPoints {
  FramePoints(DividedGatherPoints points, const SceneFrame& frame);

  std::size_t anchored = 0;  ///< number of points on static surfaces; they are the first ones
  std::string places_hash;   ///< hash of the positions and normals of these points
  std::string high_hash;     ///< hash of high_shares; "" without
};

/// Unit of stored distances in a segment, m: the diagonal of the scene over the segment.
float sample_unit(const SceneFrame& frame);

/// Reads a file into `kept`, which must be empty, in the space of the frame `now`.
formats::RadsamplesFile read_kept(const std::string& file, const SceneFrame& now, KeptHemispheres& kept);
/// Throws InputError unless the frame `now` can continue from a file: both must have the same segment, the same static
/// points and the same part of the light.
void check_kept(const std::string& file, const formats::RadsamplesHeader& header, const SceneFrame& now,
                const FramePoints& points, const KeptHemispheres& kept);

/// Writes the files of a range of frames in order. A whole file is followed by overlays on it as long as at least half
/// of their samples are the whole file's; then the next whole file follows.
class KeptFiles {
 public:
  using WriteBytes = std::function<void(const void*, std::size_t)>;

  /// Writes the samples of a frame. `path`: the file's final name; "": a stream, which is a whole file and no base of
  /// others. A file in another folder than the last whole file is a whole file, too.
  void write(const KeptHemispheres& kept, const SceneFrame& frame, const FramePoints& points,
             const std::string& history, const std::string& path, const WriteBytes& sink);

 private:
  void make_base(const std::string& path, const formats::RadsamplesHeader& header, const std::string& digest,
                 const std::vector<std::string>& hashes);
  bool lay_over_base(const std::string& path, const std::vector<std::string>& hashes,
                     formats::RadsamplesFile& file) const;

  std::string path_, digest_, points_hash_;  ///< of the last whole file; "": none
  bool divided_ = false;                     ///< true if its samples leave out the high part
  std::array<std::int32_t, 2> segment_{};
  std::unordered_map<std::string, std::uint32_t> records_;  ///< its records by the hash of their samples
};

}  // namespace tempolux
