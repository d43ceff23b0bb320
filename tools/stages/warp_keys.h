// tools/stages/warp_keys.h -- the key frames of a warp: read, checked, and set beside the frame to make.
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

/// A key as it was read.
struct LoadedKey {
  std::string file, history;
  formats::Identity identity;
  std::optional<int> frame;  ///< tempolux:frame
  std::unique_ptr<KeyFrame> key;
  std::vector<Vec3d> points;  ///< grid_of_points()
};

/// One or two keys of one size and with the same colour channels. InputError otherwise, and for a key without depth,
/// colour or camera. A key that another program wrote is taken with one warning.
std::vector<LoadedKey> load_keys(Tool& tool, const std::vector<std::string>& files);

/// Frames of a scene as a warp needs them, each evaluated once.
class FramesOfScene {
 public:
  FramesOfScene(Tool& tool, SceneInput& input, int width, int height);

  /// Frames outside the animation hold its ends. asked: the user has named it, and is warned then.
  const SceneFrame& at(int frame, bool asked = false);
  const CameraView& view(int frame);
  const FrameCamera& camera(int frame);
  /// Forgets all but these, and what lies within one frame of them.
  void keep(const std::vector<int>& frames);

 private:
  struct Kept;
  Kept& kept(int frame, bool asked);

  SceneInput& input_;
  int width_, height_, node_;
  std::map<int, std::shared_ptr<Kept>> frames_;
};

/// Checks each key against the scene at its own frame: identity, and that it was seen by the camera asked for
/// (InputError; with
/// --allow-stale a warning). `number`: the frame to make. Says which keys are cut off from it.
class KeysOfFrame {
 public:
  KeysOfFrame(Tool& tool, const std::vector<LoadedKey>& keys, FramesOfScene& frames, int number);
  /// Without a scene: nothing is known to move, no cut is looked for.
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
