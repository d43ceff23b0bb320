// tools/common/scene_input.h -- the scene argument of a tool: loaded once, evaluated at the frames it is asked for.
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

/// A scene file under the common options of a tool: its warnings are passed on, its files are dependencies.
/// What a segment shares (static surfaces, emission table) is made once per segment.
class SceneInput {
 public:
  /// `needs`: what the scene must have (InputError otherwise), checked before anything else is said about it.
  enum Needs : unsigned { nothing = 0, light = 1, a_camera = 2 };
  SceneInput(Tool& tool, const std::string& path, unsigned needs);

  /// Counts the textures that were looked at, for stats.
  ~SceneInput();
  SceneInput(const SceneInput&) = delete;

  const Scene& scene() const { return scene_; }
  const TimeOptions& time() const { return time_; }
  /// The scene at a frame; frames beyond the animation hold its end, with one warning if the user has asked for them.
  /// Its media are read if it is `asked` for; for neighbours, of which only places are wanted, they are left out.
  SceneFrame at(int frame, bool asked = true);
  /// Does the scene, or the command line, name media? And the hash of those at a frame, as in SceneHashes.
  bool has_media() const { return volumes_->any(); }
  std::string media_hash(int frame);
  FrozenMajorants frozen_majorants(int first, int last) { return volumes_->freeze(first, last); }
  /// Files of media that were read so far.
  const std::vector<std::string>& media_files() const { return volumes_->files(); }
  /// The frozen emission table of the frame's segment.
  const EmissionTable& emission(int frame);

 private:
  void add_environment();
  void enter_segment(int frame, bool read_volumes);
  bool has_distant_light() const;

  Tool& tool_;
  Scene scene_;
  TimeOptions time_;
  std::optional<VolumeInput> volumes_;
  std::optional<int> bounds_of_;  ///< frame whose media the segment's bounds hold
  std::unique_ptr<SegmentScene> segment_;
  std::optional<EmissionTable> emission_;
  bool warned_range_ = false;
};

/// Which state of the scene a file made at this frame belongs to.
formats::Identity identity_of(const SceneFrame& frame);

/// Refuses a file made for another state of the scene, naming the concern, the file and the frame (InputError),
/// or warns with --allow-stale; a file without identity is accepted with one warning.
void check_identity(Tool& tool, const std::string& file, const formats::Identity& file_identity,
                    const SceneFrame& frame);

}  // namespace tempolux::tools
