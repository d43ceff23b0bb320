#include "tools/stages/warp_keys.h"

#include <cmath>
#include <cstdlib>

#include "formats/error.h"
#include "lib/image/cryptomatte.h"
#include "lib/image/exr_io.h"
#include "lib/image/frame_identity.h"

namespace tempolux::tools {
namespace {

LoadedKey load_key(Tool& tool, const std::string& file) {
  const Image image = load_exr(file, {.our_names = true});
  tool.depends_on(file);
  LoadedKey key;
  key.file = file;
  if (const auto history = image.text.find("tempolux:history"); history != image.text.end())
    key.history = history->second;
  key.identity = identity_in(image);
  if (const auto frame = image.numbers.find("tempolux:frame");
      frame != image.numbers.end() && std::abs(frame->second) < 1e8)
    key.frame = int(std::lround(frame->second));
  key.key = std::make_unique<KeyFrame>(image, file, camera_of(image, file));
  key.has_mattes = has_mattes(image);
  key.points = grid_of_points(key.key->seen(), key.key->camera());
  return key;
}

bool is_foreign(const LoadedKey& key) { return key.history.empty() && !key.identity.known(); }

/// Gives one warning about all keys from other programs.
void warn_of_foreign(Tool& tool, const std::vector<LoadedKey>& keys) {
  std::string files;
  for (const LoadedKey& key : keys)
    if (is_foreign(key)) files += (files.empty() ? "" : ", ") + key.file;
  if (!files.empty())
    tool.warn(files + ": by another program: taken as linear radiance of this scene, Z along the view axis in metres");
}

/// True if two frames are known to have different light on static surfaces.
bool light_differs(const formats::Identity& a, const formats::Identity& b) {
  const auto differ = [](const std::string& x, const std::string& y) { return !x.empty() && !y.empty() && x != y; };
  return differ(a.lights, b.lights) || differ(a.moving_geometry, b.moving_geometry) ||
         differ(a.materials, b.materials) || differ(a.media, b.media);
}

/// True if cameras of one frame are equal within float32, the precision of attributes.
bool same_attributes(const FrameCamera& a, const FrameCamera& b, const std::vector<Vec3d>& points) {
  for (const Vec3d& point : points) {
    const auto x = a.project(a.camera_from_world().point(point)), y = b.project(b.camera_from_world().point(point));
    if (x && y && std::hypot(x->x - y->x, x->y - y->y) > 0.01) return false;
  }
  return a.width() == b.width() && a.height() == b.height();
}

}  // namespace

std::vector<LoadedKey> load_keys(Tool& tool, const std::vector<std::string>& files) {
  std::vector<LoadedKey> keys;
  for (const std::string& file : files) keys.push_back(load_key(tool, file));
  const KeyFrame& first = *keys[0].key;
  for (const LoadedKey& key : keys) {
    if (key.key->camera().width() != first.camera().width() || key.key->camera().height() != first.camera().height())
      throw InputError(key.file + ": is not of the size of " + first.name() + "; render both alike");
    if (key.key->colour_names() != first.colour_names())
      throw InputError(key.file + ": has other colour layers than " + first.name() +
                       "; render both with the same --channels");
  }
  warn_of_foreign(tool, keys);
  return keys;
}

struct FramesOfScene::Kept {
  SceneFrame frame;
  CameraView view;
  FrameCamera camera;
};

FramesOfScene::FramesOfScene(Tool& tool, SceneInput& input, int width, int height)
    : input_(input), width_(width), height_(height), node_(input.scene().camera_node(tool.common().camera)) {}

FramesOfScene::Kept& FramesOfScene::kept(int number, bool asked) {
  std::shared_ptr<Kept>& kept = frames_[number];
  if (!kept) {
    SceneFrame frame = input_.at(number, asked);
    const CameraView view(frame, node_, width_, height_);
    const FrameCamera camera(view.world_to_camera(), view.world_to_ndc(), width_, height_);
    kept = std::make_shared<Kept>(Kept{std::move(frame), view, camera});
  }
  return *kept;
}

const SceneFrame& FramesOfScene::at(int frame, bool asked) { return kept(frame, asked).frame; }
const CameraView& FramesOfScene::view(int frame) { return kept(frame, false).view; }
const FrameCamera& FramesOfScene::camera(int frame) { return kept(frame, false).camera; }

void FramesOfScene::keep(const std::vector<int>& frames) {
  std::erase_if(frames_, [&](const auto& entry) {
    for (const int frame : frames)
      if (std::abs(entry.first - frame) <= 1) return false;
    return true;
  });
}

void KeysOfFrame::add(const LoadedKey& key, const FrameCamera& camera, const FrameCamera& target,
                      const formats::Identity& identity) {
  views_.push_back(std::make_unique<KeyView>(*key.key, camera, target, *motions_.back()));
  WarpKey warp_key;
  warp_key.view = views_.back().get();
  warp_key.light_may_differ = light_differs(key.identity, identity);
  keys_.push_back(warp_key);
}

KeysOfFrame::KeysOfFrame(Tool& tool, const std::vector<LoadedKey>& keys, FramesOfScene& frames, int number) {
  const SceneFrame& here = frames.at(number, true);
  for (const LoadedKey& key : keys) {
    if (!key.frame)
      throw InputError(key.file +
                       ": attribute tempolux:frame is missing: at which frame of the scene it was rendered is not "
                       "known; write it (a double), or give --view instead of --scene");
    const SceneFrame& there = frames.at(*key.frame);
    if (!is_foreign(key)) check_identity(tool, key.file, key.identity, there);
    const bool same = same_attributes(key.key->camera(), frames.camera(*key.frame), key.points);
    // The scene's camera has double precision; the attributes hold its rounded values.
    const FrameCamera& camera = same ? frames.camera(*key.frame) : key.key->camera();
    if (!same)
      tool.refuse_stale(key.file + ": seen by another camera than the scene has at frame " + std::to_string(*key.frame),
                        "give a key of this camera (--camera)");
    motions_.push_back(std::make_unique<ObjectMotions>(here, there));
    add(key, camera, frames.camera(number), identity_of(here));
    keys_.back().frames_away = std::abs(double(number) - *key.frame);
    const int step = number < *key.frame ? -1 : 1;
    for (int f = *key.frame; f != number && !keys_.back().cut_off; f += step) {
      keys_.back().cut_off = is_cut(key.points, frames.camera(f), frames.camera(f + step));
      std::vector<int> needed{number, f + step};  // for a distant key, not all frames between are kept
      for (const LoadedKey& each : keys) needed.push_back(each.frame.value_or(number));
      frames.keep(needed);
    }
  }
}

KeysOfFrame::KeysOfFrame(const std::vector<LoadedKey>& keys, const FrameCamera& target,
                         const formats::Identity& target_identity) {
  for (const LoadedKey& key : keys) {
    motions_.push_back(std::make_unique<ObjectMotions>());
    add(key, key.key->camera(), target, target_identity);
    keys_.back().frames_away = 1;
  }
}

}  // namespace tempolux::tools
