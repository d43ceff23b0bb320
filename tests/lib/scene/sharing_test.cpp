// Which surfaces are instances and which are copies: at the limits that place_surfaces.h states.
#include <gtest/gtest.h>

#include "lib/scene/place_surfaces.h"

namespace tempolux {
namespace {

/// A mesh of that many triangles in the cube [-1, 1]^3 (diagonal 2 sqrt(3)), on so many nodes.
Scene standing(std::size_t triangles, std::size_t nodes) {
  Scene scene;
  Primitive primitive;
  primitive.positions = {{-1, -1, -1}, {1, 1, 1}, {1, -1, 0}};
  primitive.triangles.assign(triangles, {0, 1, 2});
  scene.materials.emplace_back();
  scene.meshes.push_back({"m", {primitive}});
  scene.nodes.resize(nodes);
  for (Node& node : scene.nodes) node.mesh = 0;
  return scene;
}
bool instanced(const Scene& scene, const Affine& place = {}) {
  return Sharing(scene).instanced(scene.meshes[0].primitives[0], place);
}
Affine stretched(double z) {
  Affine m;
  m.row[2].z = z;
  return m;
}
Affine moved(double x) {
  Affine m;
  m.translation.x = x;
  return m;
}

TEST(Sharing, OfPrimitivesThatAreLargeAndStandTwice) {
  EXPECT_TRUE(instanced(standing(4096, 2)));
  EXPECT_FALSE(instanced(standing(4095, 2)));
  EXPECT_FALSE(instanced(standing(4096, 1)));
  Scene by_instances = standing(4096, 1);
  by_instances.nodes[0].instances.resize(2);
  EXPECT_TRUE(instanced(by_instances));
}

TEST(Sharing, OfSmallPrimitivesWithManyCopies) {
  EXPECT_TRUE(instanced(standing(256, 1024)));
  EXPECT_FALSE(instanced(standing(256, 1023)));
  EXPECT_FALSE(instanced(standing(255, 4096)));
}

TEST(Sharing, NotOfWhatShinesOrLetsRaysPass) {
  Scene lamp = standing(4096, 2), leaf = standing(4096, 2);
  lamp.materials[0].emission = Rgb(1.0f);
  leaf.materials[0].alpha_mode = Material::Alpha::mask;
  EXPECT_FALSE(instanced(lamp));
  EXPECT_FALSE(instanced(leaf));
}

TEST(Sharing, NotWhereRoundingWouldShow) {
  // sqrt(2 + s^2) sqrt(2 + 1 / s^2) is 29.8 for s = 21 and 31.2 for 22.
  const Scene scene = standing(4096, 2);
  EXPECT_TRUE(instanced(scene, stretched(21)));
  EXPECT_FALSE(instanced(scene, stretched(22)));
  EXPECT_FALSE(instanced(scene, stretched(0)));
  EXPECT_TRUE(instanced(scene, moved(886)));  // 256 x 2 sqrt(3) = 886.8
  EXPECT_FALSE(instanced(scene, moved(888)));
}

}  // namespace
}  // namespace tempolux
