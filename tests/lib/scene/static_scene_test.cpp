// The static scene: its hashes are those of the file without the mover, no ray meets moving surfaces, and moving
// lights are off.
#include "lib/scene/static_scene.h"

#include <algorithm>
#include <tuple>

#include "lib/scene/scene_hash.h"
#include "tests/lib/scene/gltf_maker.h"
#include "tests/support/scenes.h"
#include "tests/support/scene_at_frame.h"

namespace tempolux {
namespace {

/// A static triangle, a moving triangle if `there`, and a lamp, which moves if `lamp_moves`.
Scene scene_with(bool there, bool lamp_moves = false) {
  GltfMaker maker;
  const int mesh = maker.add_triangle();
  maker.json["materials"] = {{{"name", "first"}}, {{"name", "second"}, {"emissiveFactor", {1, 1, 1}}}};
  maker.json["meshes"][std::size_t(mesh)]["primitives"][0]["material"] = 0;
  const int other = maker.add_triangle();
  maker.json["meshes"][std::size_t(other)]["primitives"][0]["material"] = 1;
  maker.json["extensionsUsed"] = {"KHR_lights_punctual"};
  maker.json["extensions"]["KHR_lights_punctual"]["lights"] = {{{"type", "point"}, {"intensity", 2}}};
  if (there) maker.add_node({{"mesh", other}});
  else maker.add_node({{"name", "nothing"}});
  maker.add_node({{"mesh", mesh}});
  maker.add_node({{"extensions", {{"KHR_lights_punctual", {{"light", 0}}}}}});
  if (there) maker.animate(0, "translation", {0, 1}, {0, 0, 0, 1, 0, 0});
  if (lamp_moves) maker.animate(2, "translation", {0, 1}, {0, 0, 0, 1, 0, 0});
  return maker.load();
}

SceneFrame frame_of(const Scene& scene, int frame) {
  return scene_at_frame(scene, segment_of(scene, frame, {}), frame, {});
}

TEST(Standing, HashesAreThoseOfTheFileWithoutTheMover) {
  const Scene with = scene_with(true), without = scene_with(false);
  const SceneFrame moving = frame_of(with, 5), standing = static_scene_of(moving);
  const SceneFrame other = frame_of(without, 0), still = static_scene_of(other);
  ASSERT_EQ(moving.surfaces.size(), 2u);
  EXPECT_EQ(moving.static_count, 1u);
  EXPECT_EQ(standing.hashes.materials, still.hashes.materials);
  EXPECT_EQ(standing.hashes.lights, still.hashes.lights);
  EXPECT_EQ(still.hashes.lights, other.hashes.lights);
  EXPECT_EQ(still.hashes.materials, other.hashes.materials);
  EXPECT_EQ(standing.hashes.moving_geometry, still.hashes.moving_geometry);
  EXPECT_NE(standing.hashes.lights, moving.hashes.lights);  // the mover emits
  // Every frame of the segment has the same.
  const SceneFrame later = static_scene_of(frame_of(with, 9));
  EXPECT_EQ(later.hashes.static_geometry, standing.hashes.static_geometry);
  EXPECT_EQ(later.hashes.lights, standing.hashes.lights);
}

TEST(Standing, MoversAreThereAndHaveNoArea) {
  const Scene scene = scene_with(true);
  const SceneFrame standing = static_scene_of(frame_of(scene, 5));
  ASSERT_EQ(standing.surfaces.size(), 2u);
  for (const Vec3& p : standing.surfaces[1].positions) EXPECT_EQ(p, Vec3{});
  EXPECT_GT(length(standing.surfaces[0].position(1) - standing.surfaces[0].position(0)), 0);
}

TEST(Standing, MovingLampsAreOff) {
  const Scene scene = scene_with(false, true);
  const SceneFrame moving = frame_of(scene, 5), standing = static_scene_of(moving);
  ASSERT_EQ(standing.lights.size(), 1u);
  EXPECT_EQ(standing.lights[0].light.intensity, Rgb(0.0f));
  EXPECT_NE(moving.lights[0].light.intensity, Rgb(0.0f));
}

TEST(Standing, WhatHasAnAnimatedMaterialMoves) {
  GltfMaker maker;
  const int mesh = maker.add_triangle();
  maker.json["materials"] = {{{"name", "first"}}};
  maker.json["meshes"][std::size_t(mesh)]["primitives"][0]["material"] = 0;
  maker.add_node({{"mesh", mesh}});
  maker.json["extensionsUsed"] = {"KHR_animation_pointer"};
  maker.json["animations"] = {
      {{"samplers", {{{"input", maker.add_scalars({0, 1})}, {"output", maker.add_scalars({0, 1})}}}},
       {"channels",
        {{{"sampler", 0},
          {"target",
           {{"path", "pointer"},
            {"extensions",
             {{"KHR_animation_pointer", {{"pointer", "/materials/0/pbrMetallicRoughness/roughnessFactor"}}}}}}}}}}}};
  const Scene scene = maker.load();
  const Segment segment = segment_of(scene, 0, {});
  EXPECT_EQ(segment.node_moves[0], 1);
  EXPECT_EQ(segment.why_moves[0], "roughness of its material");
  EXPECT_EQ(frame_of(scene, 3).static_count, 0u);
}

TEST(Standing, BoxesHoldWhatMoves) {
  const Scene scene = scene_with(true);
  MovingBoxes boxes = moving_boxes(frame_of(scene, 0));
  ASSERT_EQ(boxes.surfaces.size(), 1u);
  const float first = boxes.all.upper.x;
  boxes.add(moving_boxes(frame_of(scene, 12)));
  EXPECT_NEAR(boxes.all.upper.x, first + 0.5f, 1e-4f);
  EXPECT_TRUE(moving_boxes(frame_of(scene_with(false), 0)).all.empty());
}

/// Pieces of a ball in one frame and in two: each triangle lies in one piece, and the pieces are much smaller than
/// the ball's box.
TEST(Standing, PiecesHoldAllTriangles) {
  const auto ball_at = [](float x) {
    test::HandMadeScene scene;
    scene.add_sphere({x, 2, -3}, 0.5f, 8, test::matte(Rgb(0.5f)), false, false, true);
    MovingBoxes boxes = moving_boxes(scene.frame());
    const auto inside = [](const Box3& a, const Box3& b) {
      return a.lower.x >= b.lower.x && a.lower.y >= b.lower.y && a.lower.z >= b.lower.z && a.upper.x <= b.upper.x &&
             a.upper.y <= b.upper.y && a.upper.z <= b.upper.z;
    };
    return std::tuple(
        boxes, [positions = scene.last_positions(), triangles = scene.frame().surfaces[0].primitive->triangles,
                inside](const MovingBoxes& of) {
          for (const auto& corners : triangles) {
            Box3 triangle;
            for (const std::uint32_t corner : corners) triangle.add(positions[corner]);
            if (std::ranges::none_of(of.pieces_of(0), [&](const Box3& piece) { return inside(triangle, piece); }))
              return false;
          }
          return true;
        });
  };
  auto [first, holds_first] = ball_at(0);
  const auto [second, holds_second] = ball_at(0.25f);
  ASSERT_EQ(first.pieces_of(0).size(), 64u);
  EXPECT_TRUE(holds_first(first));
  EXPECT_FALSE(holds_second(first));
  for (const Box3& piece : first.pieces_of(0))
    EXPECT_TRUE(piece.empty() || piece.diagonal() < 0.5f * first.surfaces[0].diagonal());
  first.add(second);
  EXPECT_TRUE(holds_first(first));
  EXPECT_TRUE(holds_second(first));
  MovingBoxes none;
  none.add(second);
  EXPECT_EQ(none.pieces_of(0).size(), 64u);
  none.surfaces.assign(1, Box3{{0, 0, 0}, {1, 1, 1}}), none.pieces.clear();
  none.add(second);
  EXPECT_TRUE(none.pieces_of(0).empty());  // of one of them the box is all that is known
}

}  // namespace
}  // namespace tempolux
