// The camera of scenes without one: the picture shows all corners, but grounds and distant small parts do not
// determine the view.
#include "lib/scene/content_camera.h"

#include <cmath>

#include "tests/lib/scene/gltf_maker.h"
#include "tests/support/scene_at_frame.h"

namespace tempolux {
namespace {

/// A box of 12 triangles from -h to h on all axes but upwards from 0 to 2 h.
int add_box(GltfMaker& maker, float h) {
  std::vector<float> corners;
  for (int i = 0; i < 8; ++i)
    for (const float x : {i & 1 ? h : -h, i & 2 ? 2 * h : 0.0f, i & 4 ? h : -h}) corners.push_back(x);
  return maker.add_mesh({{"attributes", {{"POSITION", maker.add_vec3(corners)}}},
                         {"indices", maker.add_indices({0, 2, 1, 1, 2, 3, 4, 5, 6, 5, 7, 6, 0, 1, 4, 1, 5, 4,
                                                        2, 6, 3, 3, 6, 7, 0, 4, 2, 2, 4, 6, 1, 3, 5, 3, 7, 5})}});
}

int add_ground(GltfMaker& maker, float half) {
  return maker.add_mesh(
      {{"attributes", {{"POSITION", maker.add_vec3({-half, 0, -half, half, 0, -half, half, 0, half, -half, 0, half})}}},
       {"indices", maker.add_indices({0, 2, 1, 0, 3, 2})}});
}

PlacedCamera camera_of(const GltfMaker& maker, std::string* said = nullptr) {
  Scene scene = maker.load();
  EXPECT_FALSE(scene.has_camera());
  const std::string line = add_content_camera(scene);
  if (said) *said = line;
  EXPECT_TRUE(scene.has_camera());
  return scene_at_frame(scene, segment_of(scene, 0, {}), 0, {}).camera(scene.camera_node("auto"));
}

/// Position of a point in a picture of 4:3: -1 to 1 from border to border; x above 10: the point is behind the
/// camera.
std::array<double, 2> seen_at(const PlacedCamera& placed, Vec3d point) {
  const Vec3d p = inverse(placed.scene_from_camera).point(point);
  const double t = std::tan(placed.camera.yfov_rad / 2);
  return p.z < 0 ? std::array{p.x / (-p.z * t * 4 / 3), p.y / (-p.z * t)} : std::array{99.0, 99.0};
}

/// The largest coordinate of the corners of the box of half length h: 1 where it touches the border.
double largest(const PlacedCamera& placed, double h, Vec3d at = {}) {
  double most = 0;
  for (int i = 0; i < 8; ++i) {
    const auto [x, y] = seen_at(placed, at + Vec3d{i & 1 ? h : -h, i & 2 ? 2 * h : 0, i & 4 ? h : -h});
    most = std::max({most, std::abs(x), std::abs(y)});
  }
  return most;
}

TEST(ContentCamera, AnObjectFillsThePictureToItsMargin) {
  for (const float h : {1e-3f, 1.0f, 1e4f}) {
    GltfMaker maker;
    maker.add_node({{"mesh", add_box(maker, h)}});
    std::string said;
    const PlacedCamera camera = camera_of(maker, &said);
    EXPECT_NEAR(largest(camera, h), 1 / 1.06, 1e-4);  // the margin of 6 %
    EXPECT_CONTAINS(said, "no camera: --camera auto looks at what the scene holds from (");
    // From the front, above and a little to the right.
    const Vec3d eye = camera.scene_from_camera.translation;
    EXPECT_GT(eye.z, eye.x);
    EXPECT_GT(eye.x, 0);
    EXPECT_GT(eye.y, 2 * h);
  }
}

/// A node of scale 0 hides what it holds. The camera then stands 1 m before the origin.
TEST(ContentCamera, LooksAtTheOriginIfAllIsHidden) {
  GltfMaker maker;
  maker.add_node({{"mesh", add_box(maker, 1)}, {"scale", {0, 0, 0}}});
  const auto [x, y] = seen_at(camera_of(maker), {0, 0, 0});
  EXPECT_LT(std::max(std::abs(x), std::abs(y)), 1);
}

TEST(ContentCamera, ALargeGroundIsNotWhatItLooksAt) {
  for (const float half : {100.0f, 1e4f}) {
    GltfMaker maker;
    maker.add_node({{"mesh", add_box(maker, 2)}});
    maker.add_node({{"mesh", add_ground(maker, half)}});
    EXPECT_NEAR(largest(camera_of(maker), 2), 1 / 1.06, 1e-4) << half;
  }
  GltfMaker near;  // a ground of the box's size belongs to it
  near.add_node({{"mesh", add_box(near, 2)}});
  near.add_node({{"mesh", add_ground(near, 4)}});
  const PlacedCamera camera = camera_of(near);
  for (const Vec3d corner : {Vec3d{-4, 0, -4}, Vec3d{4, 0, -4}, Vec3d{4, 0, 4}, Vec3d{-4, 0, 4}}) {
    const auto [x, y] = seen_at(camera, corner);
    EXPECT_LE(std::max(std::abs(x), std::abs(y)), 1);
  }
}

TEST(ContentCamera, AFewSmallTrianglesAreNoReasonToLookAtThemAlone) {
  GltfMaker maker;  // a lamp of 2 triangles in a box of 12
  maker.add_node({{"mesh", add_ground(maker, 0.01f)}, {"translation", {0, 1, 0}}});
  maker.add_node({{"mesh", add_box(maker, 2)}});
  EXPECT_NEAR(largest(camera_of(maker), 2), 1 / 1.06, 1e-4);
}

TEST(ContentCamera, AStrayIsLeftOutAndTwoObjectsAreNot) {
  GltfMaker maker;
  for (int i = 0; i < 20; ++i) maker.add_node({{"mesh", add_box(maker, 2)}});
  maker.add_node({{"mesh", add_box(maker, 0.01f)}, {"translation", {1000, 0, 0}}});
  EXPECT_NEAR(largest(camera_of(maker), 2), 1 / 1.06, 1e-4);
  GltfMaker two;
  two.add_node({{"mesh", add_box(two, 2)}});
  two.add_node({{"mesh", add_box(two, 2)}, {"translation", {100, 0, 0}}});
  const PlacedCamera camera = camera_of(two);
  EXPECT_LE(std::max(largest(camera, 2), largest(camera, 2, {100, 0, 0})), 1);
}

TEST(ContentCamera, WhatMovesStaysInThePicture) {
  GltfMaker maker;
  const int mover = maker.add_node({{"mesh", add_box(maker, 1)}});
  maker.animate(mover, "translation", {0, 3}, {0, 0, 0, 20, 0, 0});
  const PlacedCamera camera = camera_of(maker);
  for (const double x : {0.0, 10.0, 20.0}) EXPECT_LE(largest(camera, 1, {x, 0, 0}), 1) << x;
}

TEST(ContentCamera, FarFromTheOriginItIsTheSamePicture) {
  GltfMaker maker;
  maker.add_node({{"mesh", add_box(maker, 1)}, {"translation", {3e6, 0, 1e6}}});
  Scene scene = maker.load();
  add_content_camera(scene);
  const SceneFrame frame = scene_at_frame(scene, segment_of(scene, 0, {}), 0, {});
  const PlacedCamera camera = frame.camera(scene.camera_node("auto"));
  EXPECT_NEAR(largest(camera, 1, Vec3d{3e6, 0, 1e6} - frame.origin), 1 / 1.06, 1e-3);
}

}  // namespace
}  // namespace tempolux
