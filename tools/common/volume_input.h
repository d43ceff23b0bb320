// tools/common/volume_input.h -- the media of a scene: from --volume and its options, or from the scene's nodes.
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "lib/scene/volumes.h"
#include "lib/volume/majorants_file.h"
#include "lib/volume/vdb_file.h"
#include "tools/common/tool_main.h"

namespace tempolux::tools {

/// Reads the media of frames, and keeps some of them in memory.
class VolumeInput {
 public:
  /// `--volume` replaces the media that the scene names; "none" removes them. Throws InputError for options that
  /// contradict each other.
  VolumeInput(Tool& tool, const Scene& scene);

  bool any() const { return !sources_.empty(); }
  /// True if the majorants come from a file, --majorants.
  bool frozen() const { return !tool_.common().volume.majorants.empty(); }
  /// The last frame for which any volume has a file. -1 if there is no volume, or one does not name its frames.
  int last_frame() const;
  /// The media of a frame in scene space, whose origin in world space is `origin`; nullptr: none. Their files become
  /// dependencies of the tool.
  std::shared_ptr<const Media> at(int frame, Vec3d origin);
  /// The same media without majorants.
  std::vector<Medium> read(int frame, Vec3d origin);
  /// Warns, at most once, if nothing sees the media of a frame, as volumes.h defines. `geometry` is the box of the
  /// scene's triangles, world space, m.
  void look_for(const SceneFrame& frame, const Box3d& geometry);
  /// All files read so far.
  const std::vector<std::string>& files() const { return files_; }
  /// Majorants that are valid for these frames; world space.
  FrozenMajorants freeze(int first, int last);
  /// Hash of what read() gives, for SceneHashes::media.
  static std::string hash(const std::vector<Medium>& media);

 private:
  Tool& tool_;
  std::vector<VolumeSource> sources_;
  std::vector<std::string> files_;
  std::optional<VdbSeries> series_;
  /// The majorants of --majorants in scene space; nullptr without the option.
  const MajorantGrid* majorants_for(int frame, Vec3d origin);
  /// Reads the media from their files.
  std::vector<Medium> parse(int frame, Vec3d origin);
  struct Kept {
    Vec3d origin;
    std::vector<Medium> media;
  };
  /// A result of at().
  struct At {
    int frame = 0;
    Vec3d origin;
    std::shared_ptr<const Media> media;
  };
  /// Warns unless a warning of this kind was given.
  void warn_once(const std::string& kind, const std::string& warning);
  std::set<std::string> warned_;
  std::map<int, Kept> kept_;  ///< results of read(), up to kMostKept bytes
  std::size_t kept_bytes_ = 0;
  std::optional<FrozenMajorants> majorants_;
  MajorantGrid scene_majorants_;
  std::optional<At> last_;
};

}  // namespace tempolux::tools
