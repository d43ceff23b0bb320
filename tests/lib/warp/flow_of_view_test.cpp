// Pixel flow against closed forms: planes under homographies, there and back again, speeds in degrees.
#include "tests/lib/warp/warp_fixture.h"

#include <numbers>

#include "lib/warp/camera_cut.h"

namespace tempolux::test {
namespace {

/// A second, independent description of a pinhole camera: eye, turn about +y, half the picture's height at distance
/// 1.
struct Pinhole {
  Vec3d eye;
  double turn, yfov;
  int width, height;
  std::array<double, 2> shift{};  // in heights of the picture

  double scale() const { return height / (2 * std::tan(yfov / 2)); }  // pixels per unit at distance 1
  Vec3d ray(double x, double y) const {
    const double px = (x - width / 2.0 + height * shift[0]) / scale(),
                 py = (height / 2.0 - y + height * shift[1]) / scale();
    return {px * std::cos(turn) - std::sin(turn), py, -px * std::sin(turn) - std::cos(turn)};
  }
  RasterPoint project(Vec3d p) const {
    const Vec3d d = p - eye;
    const double right = d.x * std::cos(turn) - d.z * std::sin(turn),
                 ahead = -d.x * std::sin(turn) - d.z * std::cos(turn);
    return {width / 2.0 + scale() * right / ahead - height * shift[0],
            height / 2.0 - scale() * d.y / ahead + height * shift[1]};
  }
};

constexpr double kBack = -1.4;  // z of the back wall, of objects 3 in the room

/// A plane seen by two cameras is mapped by a homography: here by following each pixel's ray to the wall z = -1.4 and
/// projecting the point. Flow starts from depth in float32, 6e-8 of 3 m, which moves a point by 1e-6 pixels at most.
void expect_homography(const Pinhole& a, const Pinhole& b) {
  const Cornell room;
  const int width = a.width, height = a.height;
  const auto placed = [](const Pinhole& pinhole) {
    PlacedCamera camera = camera_at(pinhole.eye, pinhole.turn, pinhole.yfov);
    camera.camera.lens_shift = pinhole.shift;
    return camera;
  };
  const View here(room, placed(a), width, height), there(room, placed(b), width, height);
  const NeighbourView other{&room.frame, &there.seen.camera()};
  const PixelFlow flow = flow_of_view(here.seen, other, other, 24);
  double squares = 0;
  int count = 0;
  for (std::size_t p = 0; p < flow.valid.size(); ++p) {
    if (std::abs(world_at(here, p).z - kBack) > 1e-5) continue;
    const double x = double(p % width) + 0.5, y = double(p / width) + 0.5;
    const Vec3d ray = a.ray(x, y);
    const RasterPoint to = b.project(a.eye + ray * ((kBack - a.eye.z) / ray.z));
    EXPECT_EQ(flow.valid[p], 3u);
    squares +=
        std::pow(double(flow.forward[p].x) - (to.x - x), 2) + std::pow(double(flow.forward[p].y) - (y - to.y), 2);
    ++count;
  }
  ASSERT_GT(count, 5000);
  EXPECT_LT(std::sqrt(squares / count), 1e-4);
}

TEST(FlowOfView, OfAPlaneIsItsHomography) {
  expect_homography({{0.1, 1.2, 1.8}, 0.05, 0.7, 320, 240}, {{-0.15, 1.1, 1.5}, -0.1, 0.7, 320, 240});
}

TEST(FlowOfView, OfAPlaneThroughShiftedLensesIsItsHomography) {
  expect_homography({{0.1, 1.2, 1.8}, 0.05, 0.7, 320, 240, {0.1, -0.05}},
                    {{-0.15, 1.1, 1.5}, -0.1, 0.7, 320, 240, {-0.05, 0.1}});
}

/// A point is followed to the next frame and back by the flow there, bilinear. It returns to its start where one
/// whole surface is seen in both frames. The bilinear flow of a plane has an error by its curvature, below .01 pixels
/// here.
TEST(FlowOfView, ForwardAndBackAgain) {
  const Cornell now(10), next(11);
  const int width = 320, height = 240;
  const View here(now, camera_at({0, 1, 1.9}), width, height),
      there(next, camera_at({0.05, 1.02, 1.85}, 0.02), width, height);
  const NeighbourView to_next{&next.frame, &there.seen.camera()}, to_here{&now.frame, &here.seen.camera()};
  const PixelFlow out = flow_of_view(here.seen, to_next, to_next, 24),
                  back = flow_of_view(there.seen, to_here, to_here, 24);
  const std::vector<std::uint8_t> whole = whole_pixels(there.seen.seen(), there.seen.camera());
  int count = 0, moving = 0;
  double worst = 0;
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const std::size_t p = std::size_t(y * width + x);
      const double cx = x + double(out.forward[p].x), cy = y - double(out.forward[p].y);
      const int x0 = int(std::floor(cx)), y0 = int(std::floor(cy));
      if (x0 < 0 || y0 < 0 || x0 + 1 >= width || y0 + 1 >= height) continue;
      double u = 0, v = 0;
      bool same = true;
      for (int dy = 0; dy < 2; ++dy)
        for (int dx = 0; dx < 2; ++dx) {
          const std::size_t q = std::size_t((y0 + dy) * width + x0 + dx);
          same &= whole[q] && there.seen.seen().object[q] == here.seen.seen().object[p];
          const double w = (dx ? cx - x0 : 1 - cx + x0) * (dy ? cy - y0 : 1 - cy + y0);
          u += w * double(back.backward[q].x);
          v += w * double(back.backward[q].y);
        }
      if (!same) continue;
      ++count;
      moving += here.seen.seen().object[p] == 8;
      worst = std::max(worst, std::hypot(double(out.forward[p].x) + u, double(out.forward[p].y) + v));
    }
  EXPECT_GT(count, width * height / 2);
  EXPECT_GT(moving, 300);  // the sliding, turning box is among them
  EXPECT_LT(worst, 0.05);
}

/// A camera that turns by .01 radians a frame sees everything turn at .01 * 180/pi * 24 degrees a second about the same
/// axis; at the middle line of the picture that is the speed itself.
TEST(FlowOfView, SpeedIsInDegreesPerSecond) {
  const Cornell room;
  const View here(room, camera_at({0, 1, 1.9}, 0.0), 96, 72), there(room, camera_at({0, 1, 1.9}, 0.01), 96, 72);
  const NeighbourView next{&room.frame, &there.seen.camera()}, same{&room.frame, &here.seen.camera()};
  const PixelFlow turning = flow_of_view(here.seen, next, same, 24), standing = flow_of_view(here.seen, same, next, 24);
  const std::size_t middle = 36 * 96 + 48;
  EXPECT_NEAR(turning.speed[middle], 0.01 * 180 / std::numbers::pi * 24, 1e-3);
  EXPECT_EQ(standing.speed[middle], 0);
  EXPECT_EQ(standing.forward[middle], (Vec2{0, 0}));
  EXPECT_EQ(standing.valid[middle], 3u);
  // 1e-9 radians: an arc cosine of floats would say 0.
  EXPECT_NEAR(angular_speed({0, 0, 1}, {1e-9, 0, 1}, 24) / (1e-9 * 180 / std::numbers::pi * 24), 1, 1e-6);
}

TEST(CameraCut, AJumpIsOneAndAPanIsNot) {
  const Cornell room;
  const View here(room, camera_at({0, 1, 1.9}, 0.0));
  const auto camera = [&](Vec3d eye, double turn) { return View(room, camera_at(eye, turn)).seen.camera(); };
  const std::vector<Vec3d> points = grid_of_points(here.seen.seen(), here.seen.camera());
  EXPECT_FALSE(is_cut(points, here.seen.camera(), camera({0, 1, 1.9}, 0.1)));  // 140 degrees a second
  EXPECT_FALSE(is_cut(points, here.seen.camera(), camera({0.1, 1, 1.8}, 0)));
  EXPECT_TRUE(is_cut(points, here.seen.camera(), camera({0, 1, 1.9}, 0.5)));  // teleported view
  EXPECT_TRUE(is_cut(points, here.seen.camera(), camera({0, 1, 1.9}, std::numbers::pi)));
}

}  // namespace
}  // namespace tempolux::test
