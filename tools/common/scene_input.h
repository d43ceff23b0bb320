// tools/common/scene_input.h -- a tool's scene: loaded once, evaluated at frames on request.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "formats/identity.h"
#include "lib/light/lights.h"
#include "lib/scene/at_frame.h"
#include "tools/common/tool_main.h"
#include "tools/common/volume_input.h"

namespace tempolux::tools {

/// A scene file under a tool's common options: its warnings are passed on, and its files are dependencies. Data that a
/// segment shares (static surfaces, emission table) is made once per segment.
class SceneInput {
 public:
  /// `needs`: what the scene must have (else InputError); checked before warnings are given.
  enum Needs : unsigned { nothing = 0, light = 1, a_camera = 2 };
  SceneInput(Tool& tool, const std::string& path, unsigned needs);

  /// Adds the number of decoded textures to stats.
  ~SceneInput();
  SceneInput(const SceneInput&) = delete;

  const Scene& scene() const { return scene_; }
  const TimeOptions& time() const { return time_; }
  /// The scene at a frame. Frames outside the animation have its first or last state, with one warning if the user
  /// asked for such a frame. Media are read if `asked`; for neighbouring frames, of which only positions are needed,
  /// they are left out.
  SceneFrame at(int frame, bool asked = true);
  /// True if the scene or the command line names media. media_hash() is the media's hash at a frame, as in
  /// SceneHashes.
  bool has_media() const { return volumes_->any(); }
  std::string media_hash(int frame);
  FrozenMajorants frozen_majorants(int first, int last) { return volumes_->freeze(first, last); }
  /// Media files read so far.
  const std::vector<std::string>& media_files() const { return volumes_->files(); }
  /// The emission table of the frame's segment.
  const EmissionTable& emission(int frame);

 private:
  void add_environment();
  void set_lens();
  void set_shutter(CameraExtras& extras);
  void check_lens(const SceneFrame& frame) const;
  void enter_segment(int frame, bool read_volumes);

  Tool& tool_;
  Scene scene_;
  TimeOptions time_;
  std::optional<VolumeInput> volumes_;
  Box3d geometry_;                ///< of the segment's triangles, without media; world space, m
  std::optional<int> bounds_of_;  ///< frame whose media the segment's bounds enclose; empty: none yet
  int camera_node_ = -1;          ///< -1: the tool needs no camera
  std::unique_ptr<SegmentScene> segment_;
  std::optional<EmissionTable> emission_;
  bool warned_range_ = false;
};

/// Refuses a file that was made for another state of the scene, naming the concern, the file and the frame
/// (InputError); with --allow-stale only warns. A file without identity is accepted with one warning.
void check_identity(Tool& tool, const std::string& file, const formats::Identity& file_identity,
                    const SceneFrame& frame);

}  // namespace tempolux::tools
