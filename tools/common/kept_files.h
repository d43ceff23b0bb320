// tools/common/kept_files.h -- .radsamples files for the tool that keeps them: written, found again, checked.
#pragma once

#include <optional>
#include <string>

#include "lib/temporal/temporal_gather.h"
#include "tools/common/gather_input.h"

namespace tempolux::tools {

/// The points of a frame, and what samples must agree with.
struct FramePoints {
  GatherPoints read;
  std::size_t anchored = 0;      ///< the first of them lie on what stands still
  std::string places_hash;       ///< of those
};
FramePoints read_frame_points(Tool& tool, const std::string& file, const SceneFrame& frame);

/// What was kept of an earlier frame of the same segment.
struct KeptFrame {
  KeptHemispheres kept;
  std::string history;
  int frame = 0;
};

/// Unit of distances of the samples of a segment, m: the diagonal of all that is in it.
float sample_unit(const SceneFrame& frame);

/// Writes the samples of a frame.
void write_kept(const KeptHemispheres& kept, const SceneFrame& frame, const FramePoints& points, const std::string& history, Output& output);
/// Reads a file for `now`: its segment, the static points and the scene at its own frame must be those (InputError). `before` receives
/// that scene.
KeptFrame read_kept(Tool& tool, SceneInput& input, const std::string& file, const SceneFrame& now, const FramePoints& points,
                    std::optional<SceneFrame>& before);
/// Reads what an earlier run of the same command left for this frame; nothing if it is not there, not whole, or was made otherwise or from other points.
std::optional<KeptHemispheres> find_kept(const std::string& file, const SceneFrame& frame, const FramePoints& points,
                                         const std::string& history);

}  // namespace tempolux::tools
