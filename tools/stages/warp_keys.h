// tools/stages/warp_keys.h -- reads and checks the key frames of a warp.
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "formats/identity.h"
#include "lib/render/camera_view.h"
#include "lib/warp/camera_cut.h"
#include "lib/warp/warp.h"
#include "tools/common/scene_input.h"

namespace tempolux::tools {

/// A loaded key.
struct LoadedKey {
  std::string file, history;
  formats::Identity identity;
  std::optional<int> frame;  ///< from tempolux:frame
  std::unique_ptr<KeyFrame> key;
  std::vector<Vec3d> points;  ///< grid_of_points() of the key
  bool has_mattes = false;    ///< the file has channels of Cryptomatte, which are not warped
};

/// Loads one or two keys. Throws InputError if their sizes or colour channels differ, or a key lacks depth, colour or
/// camera. A key from another program is accepted with one warning.
std::vector<LoadedKey> load_keys(Tool& tool, const std::vector<std::string>& files);

/// Frames of a scene for a warp, each evaluated once.
class FramesOfScene {
 public:
  FramesOfScene(Tool& tool, SceneInput& input, int width, int height);

  /// Frames outside the animation have its first or last state. asked: the user asked for this frame, and is warned.
  const SceneFrame& at(int frame, bool asked = false);
  const CameraView& view(int frame);
  const FrameCamera& camera(int frame);
  /// Drops all frames except these and their neighbours.
  void keep(const std::vector<int>& frames);

 private:
  struct Kept;
  Kept& kept(int frame, bool asked);

  SceneInput& input_;
  int width_, height_, node_;
  std::map<int, std::shared_ptr<Kept>> frames_;
};

/// Checks each key against the scene at the key's frame: its identity, and its camera (InputError; with --allow-stale a
/// warning). `number`: the frame to make. Finds the keys that a cut separates from the frame.
class KeysOfFrame {
 public:
  KeysOfFrame(Tool& tool, const std::vector<LoadedKey>& keys, FramesOfScene& frames, int number);
  /// Without a scene: motion is unknown, and no cut is searched for.
  KeysOfFrame(const std::vector<LoadedKey>& keys, const FrameCamera& target, const formats::Identity& target_identity);

  const std::vector<WarpKey>& get() const { return keys_; }

 private:
  void add(const LoadedKey& key, const FrameCamera& camera, const FrameCamera& target,
           const formats::Identity& identity);

  std::vector<std::unique_ptr<ObjectMotions>> motions_;
  std::vector<std::unique_ptr<KeyView>> views_;
  std::vector<WarpKey> keys_;
};

}  // namespace tempolux::tools
