#include "lib/scene/centre_shutter.h"

#include <algorithm>

#include "lib/scene/camera_extras.h"
#include "lib/scene/camera_properties.h"

namespace tempolux {
namespace {

bool has_one_length(const CameraExtras& extras) {
  for (std::size_t row = 0; row < extras.lists.size(); ++row) {
    const std::vector<double>& list = extras.lists[row];
    if (camera_properties()[row].member == decltype(CameraProperty::member)(&Camera::shutter_frames) && !list.empty())
      return std::ranges::all_of(list, [&](double frames) { return frames == list.front(); });
  }
  return true;
}

}  // namespace

void centre_shutter(Scene& scene, CameraExtras& extras, double fps) {
  Camera camera;
  extras.apply(0, camera);
  if (camera.shutter == Camera::Shutter::centre || !has_one_length(extras)) return;
  const double half_s = camera.shutter_frames / 2 / fps;
  const double by_s = camera.shutter == Camera::Shutter::start ? -half_s : half_s;
  for (Animation& animation : scene.animations)
    for (AnimationTrack& track : animation.tracks)
      for (double& time_s : track.times_s) time_s += by_s;
  if (scene.duration_s > 0) scene.duration_s = std::max(0.0, scene.duration_s + by_s);
  set_shutter_position(extras, Camera::Shutter::centre);
}

}  // namespace tempolux
