// tools/stages/kept_files.h -- .radsamples files for the tool that keeps them: written, found again, checked.
#pragma once

#include <optional>
#include <string>
#include <unordered_map>
#include <vector>

#include "lib/temporal/temporal_gather.h"
#include "tools/stages/gather_input.h"

namespace tempolux::tools {

/// The points of a frame, and what samples must agree with.
struct FramePoints {
  GatherPoints read;
  std::size_t anchored = 0;        ///< the first of them lie on what stands still
  std::string places_hash;         ///< of those
  std::vector<float> high_shares;  ///< by point, of photonmap-split; empty: nothing is divided from them
  std::string high_hash;           ///< of those; "" without
};
/// `high`: the high part of points of which `file` is the low one; "": `file` holds all of the light.
FramePoints read_frame_points(Tool& tool, const std::string& file, const std::string& high, const SceneFrame& frame);

/// Nothing kept yet. Samples that take more than an eighth of --max-memory go to a file in the folder of `output`.
KeptHemispheres nothing_kept(const Tool& tool, const std::string& output);

/// Unit of distances of the samples of a segment, m: the diagonal of all that is in it.
float sample_unit(const SceneFrame& frame);

/// The files of a range of frames, in their order: a whole one, then overlays of it while at least half of their
/// samples are its own; else again a whole one, of which those after it are overlays.
class KeptFiles {
 public:
  /// Writes the samples of a frame. `output` in another folder than the whole file is whole, too.
  void write(const KeptHemispheres& kept, const SceneFrame& frame, const FramePoints& points,
             const std::string& history, Output& output);
  /// Reads what an earlier run of the same command left for this frame; nothing if it is not there, not whole, or was
  /// made otherwise, from other points or upon another base. `empty`: nothing_kept().
  std::optional<KeptHemispheres> find(const std::string& file, const SceneFrame& frame, const FramePoints& points,
                                      const std::string& history, KeptHemispheres empty);

 private:
  void make_base(const std::string& path, const formats::RadsamplesHeader& header, const std::string& digest,
                 const std::vector<std::string>& hashes);
  bool lay_over_base(const std::string& path, const std::vector<std::string>& hashes,
                     formats::RadsamplesFile& file) const;

  std::string path_, digest_, points_hash_;  ///< of the whole file; "": none
  bool divided_ = false;                     ///< its samples are without the high part
  std::array<std::int32_t, 2> segment_{};
  std::unordered_map<std::string, std::uint32_t> records_;  ///< its records by the hash of their samples
};
/// Reads a file for `now` into `kept`, which is empty: its segment, the static points, the part of the light and the
/// scene at its own frame must be those (InputError). `before` receives that scene.
void read_kept(Tool& tool, SceneInput& input, const std::string& file, const SceneFrame& now, const FramePoints& points,
               KeptHemispheres& kept, std::optional<SceneFrame>& before);

}  // namespace tempolux::tools
