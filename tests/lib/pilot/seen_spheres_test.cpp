// Spheres around what cameras see: few, tight, constant for small movements of the camera, and none where they gain
// nothing.
#include "lib/pilot/seen_spheres.h"

#include <gtest/gtest.h>

#include <cmath>
#include <optional>

#include "lib/core/random.h"
#include "tests/support/scenes.h"

namespace tempolux {
namespace {

/// `count` places on the walls of a cube of this size around `middle`, seen from its middle, and `far` places on a
/// ground that reaches `reach` to each side.
std::vector<WeighedPlace> room(Vec3d middle, double size, int count, int far = 0, double reach = 0) {
  std::vector<WeighedPlace> places;
  for (int i = 0; i < count + far; ++i) {
    const PathRandom random(3, std::uint64_t(i));
    const auto number = [&](std::uint32_t k) { return 2 * unit_double(random.bits(0, Purpose::test, k)) - 1; };
    if (i >= count) {
      places.push_back({{reach * number(0), 0, reach * number(1)}, 1, reach});
      continue;
    }
    std::array<double, 3> at{number(0), number(1), number(2)};
    at[std::size_t(i % 3)] = i % 2 ? 1 : -1;
    places.push_back({middle + Vec3d{at[0], at[1], at[2]} * (size / 2), 1, size / 2});
  }
  return places;
}

bool held(const std::vector<formats::ViewSphere>& spheres, Vec3d p) {
  for (const formats::ViewSphere& s : spheres) {
    const Vec3d to = p - Vec3d{s.centre[0], s.centre[1], s.centre[2]};
    if (dot(to, to) <= s.radius * s.radius) return true;
  }
  return false;
}

TEST(SpheresAround, ARoomInAWideLandIsHeldByFewSmallOnes) {
  const Vec3d middle{100.3, 2, -40};
  const std::vector<WeighedPlace> places = room(middle, 4, 3000);
  const std::vector<formats::ViewSphere> spheres = spheres_around(places, 700);
  ASSERT_FALSE(spheres.empty());
  EXPECT_LE(spheres.size(), formats::kMaxViewSpheres);
  for (const WeighedPlace& place : places) EXPECT_TRUE(held(spheres, place.position));
  for (const formats::ViewSphere& s : spheres) {
    EXPECT_LE(s.radius, 4 * 0.875) << "the room's own size";
    EXPECT_GE(s.radius, 0.5 * 0.875) << "a quarter of the distance seen, 2 m";
  }
}

/// A view of a hundredth of distant land does not spread the photons: the room keeps its small spheres.
TEST(SpheresAround, AGlanceOutDoesNotWidenThem) {
  const std::vector<formats::ViewSphere> spheres = spheres_around(room({5, 2, 5}, 4, 3000, 30, 500), 700);
  ASSERT_FALSE(spheres.empty());
  double small = 0, all = 0;
  for (const formats::ViewSphere& s : spheres) {
    all += s.weight;
    if (s.radius < 4) small += s.weight;
  }
  EXPECT_GT(small, 0.9 * all);
}

TEST(SpheresAround, AClosedRoomHasNone) {
  for (const double size : {0.01, 1.0, 3.0, 4.0, 5.5})
    EXPECT_TRUE(spheres_around(room({0, 0, 0}, size, 3000), size * std::sqrt(3.0) / 2).empty()) << size;
}

TEST(SpheresAround, NothingSeenHasNone) {
  EXPECT_TRUE(spheres_around({}, 10).empty());
  EXPECT_TRUE(spheres_around({WeighedPlace{{0, 0, 0}, 1, 1}}, 10).empty());
}

/// All places at one point: one cell of finite size, although it could be divided further.
TEST(SpheresAround, OnePlaceIsOneCell) {
  const std::vector<formats::ViewSphere> spheres =
      spheres_around({WeighedPlace{{10, 1, 3}, 1, 2}, WeighedPlace{{10, 1, 3}, 1, 2}}, 1000);
  ASSERT_EQ(spheres.size(), 1u);
  EXPECT_EQ(spheres[0].radius, 0.5 * 0.875);
}

/// A step of a millimetre moves places of a room of 4 m, but no cell.
TEST(SpheresAround, ASmallStepLeavesThemAsTheyAre) {
  const std::vector<WeighedPlace> before = room({100.3, 2.2, -40.6}, 4, 3000),
                                  after = room({100.301, 2.2, -40.6}, 4, 3000);
  EXPECT_EQ(formats::view_text({spheres_around(before, 700), {}, {}}),
            formats::view_text({spheres_around(after, 700), {}, {}}));
}

// ---- cameras on a lattice

/// A camera at `eye` that looks along -z, turned by `yaw` about +y.
PlacedCamera camera_at(Vec3d eye, double yaw) {
  PlacedCamera placed;
  placed.camera.yfov_rad = 1;
  placed.scene_from_camera.row = {Vec3d{std::cos(yaw), 0, std::sin(yaw)}, Vec3d{0, 1, 0},
                                  Vec3d{-std::sin(yaw), 0, std::cos(yaw)}};
  placed.scene_from_camera.translation = eye;
  return placed;
}

class CamerasOfARoom : public testing::Test {
 protected:
  CamerasOfARoom() {
    scene_.add_room({-2, 0, -2}, {2, 2.6f, 2}, test::matte(Rgb(0.5f)));
    scene_.add_quad({-300, -0.1f, 300}, {300, -0.1f, 300}, {300, -0.1f, -300}, {-300, -0.1f, -300},
                    test::matte(Rgb(0.5f)));
    tracer_.emplace(scene_.frame());
  }
  SeenAround look(const PlacedCamera& camera) {
    SeenAround seen;
    look_around(*tracer_, camera, 160, 90, seen);
    return seen;
  }
  test::HandMadeScene scene_;
  std::optional<Tracer> tracer_;
};

/// Walls are seen from about 2 m, where half of the picture is 1.1 m high: cells are 1 m wide, with planes at 2/3 and
/// 5/3 m. A step of directions is 19 degrees.
TEST_F(CamerasOfARoom, OfACellSeeTheSame) {
  const SeenAround first = look(camera_at({0.2, 1.2, 1}, 0.02));
  ASSERT_FALSE(first.places.empty());
  const std::string view = formats::view_text({spheres_around(first.places, 420), {}, {}});
  for (const Vec3d eye : {Vec3d{0.3, 1.2, 1}, Vec3d{0.2, 1.3, 1}, Vec3d{0.2, 1.2, 0.9}, Vec3d{-0.1, 1, 1.4}}) {
    EXPECT_EQ(formats::view_text({spheres_around(look(camera_at(eye, 0.02)).places, 420), {}, {}}), view);
    EXPECT_EQ(look(camera_at(eye, -0.1)).looked, first.looked);
  }
  EXPECT_NE(look(camera_at({0.2, 1.2, 1}, 0.5)).looked, first.looked);
  EXPECT_NE(look(camera_at({1.2, 1.2, 1}, 0.02)).looked, first.looked);
  SeenAround twice = first;
  look_around(*tracer_, camera_at({0.3, 1.2, 1}, 0), 160, 90, twice);
  EXPECT_EQ(twice.places.size(), first.places.size()) << "one cell";
}

/// In a corner most of the cell lies outside the room: no camera is placed there.
TEST_F(CamerasOfARoom, LookFromInsideAlone) {
  const SeenAround seen = look(camera_at({-1.9, 1.2, 1.9}, -0.7));
  ASSERT_FALSE(seen.places.empty());
  for (const WeighedPlace& place : seen.places) {
    EXPECT_LE(std::abs(place.position.x), 2.001);
    EXPECT_LE(std::abs(place.position.z), 2.001);
    EXPECT_GE(place.position.y, -0.001);
  }
}

}  // namespace
}  // namespace tempolux
