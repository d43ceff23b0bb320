// tools/stages/kept_files.h -- writes, finds and checks .radsamples files for gather-temporal.
#pragma once

#include <optional>
#include <string>
#include <unordered_map>
#include <vector>

#include "lib/temporal/temporal_gather.h"
#include "tools/stages/gather_input.h"

namespace tempolux::tools {

/// The points of a frame, and the data that samples must agree with.
struct FramePoints {
  GatherPoints read;
  std::size_t anchored = 0;        ///< number of first points on static surfaces
  std::string places_hash;         ///< of those
  std::vector<float> high_shares;  ///< by point, from photonmap-split; empty: points are not divided
  std::string high_hash;           ///< hash of high_shares; "" without
};
/// `high`: the high part, `file` then being the low part; "": `file` holds all light.
FramePoints read_frame_points(Tool& tool, const std::string& file, const std::string& high, const SceneFrame& frame);

/// An empty set of kept records. Samples beyond an eighth of --max-memory are stored in a file in the folder of
/// `output`.
KeptHemispheres nothing_kept(const Tool& tool, const std::string& output);

/// Unit of stored distances in a segment, m: the diagonal of the scene over the segment.
float sample_unit(const SceneFrame& frame);

/// Writes the files of a range of frames in order: a whole file, then overlays of it as long as at least half of their
/// samples are the whole file's; then again a whole file.
class KeptFiles {
 public:
  /// Writes the samples of a frame. An `output` in another folder than the last whole file is whole, too.
  void write(const KeptHemispheres& kept, const SceneFrame& frame, const FramePoints& points,
             const std::string& history, Output& output);
  /// Reads the file that an earlier run of the same command wrote for this frame. Nothing if the file is missing,
  /// truncated, or made differently: from other points or on another base. `empty`: nothing_kept().
  std::optional<KeptHemispheres> find(const std::string& file, const SceneFrame& frame, const FramePoints& points,
                                      const std::string& history, KeptHemispheres empty);

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
/// Reads a file into `kept`, which must be empty, for the frame `now`. The segment, the static points, the part of the
/// light, and the scene at the file's own frame must match (else InputError). `before` receives that scene.
void read_kept(Tool& tool, SceneInput& input, const std::string& file, const SceneFrame& now, const FramePoints& points,
               KeptHemispheres& kept, std::optional<SceneFrame>& before);

}  // namespace tempolux::tools
