// tools/common/volume_input.h -- the smoke of a scene: --volume and its companions, or what the scene's nodes name.
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "lib/scene/volumes.h"
#include "lib/volume/majorants_file.h"
#include "lib/volume/vdb_file.h"
#include "tools/common/tool_main.h"

namespace tempolux::tools {

class VolumeInput {
 public:
  /// `--volume` takes the place of what the scene names; "none" leaves that out. Throws InputError for options that do
  /// not fit each other.
  VolumeInput(Tool& tool, const Scene& scene);

  bool any() const { return !sources_.empty(); }
  /// Are the majorants those of a file, --majorants?
  bool frozen() const { return !tool_.common().volume.majorants.empty(); }
  /// Last frame that has a file, if all say; -1: not known.
  int last_frame() const;
  /// The media of a frame in scene space; nullptr: none there. Their files are dependencies of the tool.
  std::shared_ptr<const Media> at(int frame, Vec3d origin);
  /// The same, as read: no majorants made.
  std::vector<Medium> read(int frame, Vec3d origin);
  /// All that were read so far.
  const std::vector<std::string>& files() const { return files_; }
  /// Majorants that hold for these frames, world space.
  FrozenMajorants freeze(int first, int last);
  /// Hash of what read() gives, for SceneHashes::media.
  static std::string hash(const std::vector<Medium>& media);

 private:
  Tool& tool_;
  std::vector<VolumeSource> sources_;
  std::vector<std::string> files_;
  std::optional<VdbSeries> series_;
  const MajorantGrid* majorants_for(int frame, Vec3d origin);
  std::vector<Medium> parse(int frame, Vec3d origin);
  struct Kept {
    Vec3d origin;
    std::vector<Medium> media;
  };
  std::map<int, Kept> kept_;  ///< what read() gave, as far as kMostKept allows
  std::size_t kept_bytes_ = 0;
  std::optional<FrozenMajorants> majorants_;
  MajorantGrid scene_majorants_;
  std::shared_ptr<const Media> last_;  ///< what at() gave last
  int last_at_ = 0;
  Vec3d last_origin_;
  bool has_last_ = false;
};

}  // namespace tempolux::tools
