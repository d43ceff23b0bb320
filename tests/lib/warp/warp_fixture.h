// tests/lib/warp/warp_fixture.h -- keys of the example's room, painted by a formula instead of rendered.
#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <memory>

#include "lib/warp/flow_of_view.h"
#include "lib/warp/scene_view.h"
#include "lib/warp/warp.h"
#include "tests/support/frames.h"

namespace tempolux::test {

/// A camera at `eye` that looks along -z, turned about +y by `turn` radians.
inline PlacedCamera camera_at(Vec3d eye, double turn = 0, double yfov = 0.7) {
  PlacedCamera placed;
  placed.camera.kind = Camera::Kind::perspective;
  placed.camera.yfov_rad = yfov;
  const double c = std::cos(turn), s = std::sin(turn);
  placed.scene_from_camera.row = {Vec3d{c, 0, s}, Vec3d{0, 1, 0}, Vec3d{-s, 0, c}};
  placed.scene_from_camera.translation = eye;
  return placed;
}

/// The room at a frame, seen by a camera of the test.
struct View {
  const Cornell& room;
  CameraView camera;
  SceneView seen;

  View(const Cornell& room_, const PlacedCamera& placed, int width = 96, int height = 72)
      : room(room_), camera(placed, room_.frame.origin, width, height), seen(room_.tracer, camera) {}
};

/// The colour that a test gives to a point of an object.
using Paint = std::function<Rgb(Vec3d world, std::uint32_t object)>;

/// A colour that changes slowly over space, another for each object.
inline Rgb smooth_paint(Vec3d p, std::uint32_t object) {
  return {float(1 + 0.2 * p.x + 0.1 * p.y), float(1 + 0.2 * p.y - 0.1 * p.z), float(object)};
}

inline Vec3d world_at(const View& view, std::size_t pixel) {
  const FrameCamera& camera = view.seen.camera();
  const auto width = std::size_t(camera.width());
  return camera.world_from_camera().point(camera.unproject({double(pixel % width) + 0.5, double(pixel / width) + 0.5},
                                                           double(view.seen.seen().depth[pixel])));
}

/// The view as a frame: RGB painted, A 1 where something is seen, data channels.
inline Image painted(const View& view, const Paint& paint) {
  Image image{view.camera.width(), view.camera.height(), {}, {}, {}, {}};
  for (const char* name : {"R", "G", "B", "A"}) image.add(name);
  for (std::size_t p = 0; p < image.pixel_count(); ++p) {
    const std::uint32_t object = view.seen.seen().object[p];
    if (object == kNoObject) continue;
    const Rgb c = paint(world_at(view, p), object);
    image.find("R")->values[p] = c.r;
    image.find("G")->values[p] = c.g;
    image.find("B")->values[p] = c.b;
    image.find("A")->values[p] = 1;
  }
  view.seen.add_channels({"Z", "N", "id"}, image);
  return image;
}

/// A target warped from keys; owns everything that the result refers to.
struct Warped {
  std::vector<std::unique_ptr<KeyFrame>> keys;
  std::vector<std::unique_ptr<ObjectMotions>> motions;
  std::vector<std::unique_ptr<KeyView>> views;
  std::vector<WarpKey> list;
  WarpedFrame frame;

  struct Source {
    const View& view;
    Image image;
    double frames_away = 1;
    bool cut_off = false, light_may_differ = false;
  };

  Warped(const View& target, std::vector<Source> sources, WarpOptions options = {.slow_deg_per_s = 0},
         std::function<std::vector<float>(const GlossInDoubt&)> see_gloss = {}) {
    for (Source& source : sources) {
      keys.push_back(std::make_unique<KeyFrame>(source.image, "key", source.view.seen.camera()));
      motions.push_back(std::make_unique<ObjectMotions>(target.room.frame, source.view.room.frame));
      views.push_back(
          std::make_unique<KeyView>(*keys.back(), source.view.seen.camera(), target.seen.camera(), *motions.back()));
      list.push_back({views.back().get(), source.frames_away, source.cut_off, source.light_may_differ});
    }
    WarpTarget wanted{&target.seen.camera(), &target.seen.seen(), {}, nullptr, std::move(see_gloss), {}};
    wanted.look = [&](std::span<const RasterPoint> at, FacePoint* points) { target.seen.look(at, points); };
    frame = warp(wanted, list, options);
  }
  /// Colour of pixel p of the composed picture, whose channels are A B G R.
  Rgb colour(std::size_t p) const { return {frame.colour[3][p], frame.colour[2][p], frame.colour[1][p]}; }
};

}  // namespace tempolux::test
