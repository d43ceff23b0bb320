// tests/lib/scene/lamp_size_test.cpp -- the size of a light in extras: of the light, of its node, and values that are
// none.
#include "lib/scene/lamp_size.h"

#include "tests/lib/scene/gltf_maker.h"
#include "tests/support/scene_at_frame.h"

namespace tempolux {
namespace {

GltfMaker lit_by(const Json& light, const Json& node = Json::object()) {
  GltfMaker maker;
  maker.add_node({{"mesh", maker.add_triangle()}});
  maker.add_light(light, node);
  return maker;
}
SceneFrame frame_of(const GltfMaker& maker) {
  const Scene scene = maker.load();
  return scene_at_frame(scene, segment_of(scene, 0, {}), 0, {});
}
LampSize size_of(const Json& light, const Json& node = Json::object()) {
  return frame_of(lit_by(light, node)).lights.at(0).light.size;
}

/// Both names of each length, at the light or at its node; the light's own counts first. A sun has no radius and a
/// point no angle. A node's scale does not count, as for all properties of lights in glTF. Seen to fail: extras of
/// lights removed by the reader before they are read; the radius multiplied by the scale.
TEST(LampSize, IsReadFromTheLightOrItsNode) {
  const Json point{{"type", "point"}}, sun{{"type", "directional"}};
  EXPECT_EQ(size_of(point), LampSize{});
  Json own = point;
  own["extras"] = {{"radius", 0.25}, {"angle", 1}};
  EXPECT_EQ(size_of(own), (LampSize{.radius_m = 0.25f}));
  EXPECT_EQ(size_of(point, {{"extras", {{"radius_m", 0.5}}}}), (LampSize{.radius_m = 0.5f}));
  EXPECT_EQ(size_of(own, {{"extras", {{"radius_m", 0.5}}}, {"scale", {7, 7, 7}}}), (LampSize{.radius_m = 0.25f}));
  EXPECT_EQ(size_of(sun, {{"extras", {{"angle_rad", 0.5}, {"radius", 2}}}}), (LampSize{.angle_rad = 0.5f}));
  own["type"] = "directional";
  EXPECT_EQ(size_of(own), (LampSize{.angle_rad = 1}));
  EXPECT_EQ(size_of({{"type", "spot"}, {"extras", {{"radius", 0.125}}}}), (LampSize{.radius_m = 0.125f}));
  EXPECT_EQ(size_of(sun, {{"extras", {{"angle", 3.1415927410125732}}}}).angle_rad, 3.14159274f);  // pi as a float
}

/// What is no size gives a light without size, and a warning that names the light. Seen to fail: a negative radius
/// taken as it is, which makes the light tree's box empty.
TEST(LampSize, OtherValuesGiveAWarningAndNoSize) {
  for (const Json& bad : {Json(-1), Json("wide"), Json(1e10), Json::array({1, 2}), Json(true)}) {
    const GltfMaker of_light = lit_by({{"type", "point"}, {"name", "Bulb"}, {"extras", {{"radius", bad}}}}),
                    of_node = lit_by({{"type", "directional"}}, {{"name", "Sun"}, {"extras", {{"angle", bad}}}});
    EXPECT_TRUE(has_warning(of_light.load(), "lights[0] \"Bulb\".extras.radius: not read")) << bad;
    EXPECT_TRUE(has_warning(of_node.load(), "\"Sun\".extras.angle: not read")) << bad;
    EXPECT_EQ(frame_of(of_light).lights[0].light.size, LampSize{});
    EXPECT_EQ(frame_of(of_node).lights[0].light.size, LampSize{});
  }
  EXPECT_TRUE(lit_by({{"type", "point"}, {"extras", "note"}}).load().warnings.empty());
  EXPECT_TRUE(lit_by({{"type", "point"}, {"extras", {{"radius", nullptr}}}}).load().warnings.empty());
}

/// A size is part of the light, so files of light without it are stale. Two nodes may give one light two sizes.
TEST(LampSize, ChangesTheHashOfLights) {
  const auto hash = [](const Json& extras) {
    return frame_of(lit_by({{"type", "point"}}, {{"extras", extras}})).hashes.lights;
  };
  EXPECT_NE(hash({{"radius", 0.1}}), hash({{"radius", 0.2}}));
  EXPECT_NE(hash({{"radius", 0.1}}), hash({{"radius", 0}}));
  EXPECT_EQ(hash({{"radius", 0}}), hash({{"note", 1}}));
  GltfMaker shared = lit_by({{"type", "point"}}, {{"extras", {{"radius", 0.1}}}});
  Json node{{"extras", {{"radius", 0.2}}}};
  node["extensions"]["KHR_lights_punctual"]["light"] = 0;
  shared.add_node(node);
  const SceneFrame frame = frame_of(shared);
  EXPECT_EQ(frame.lights.at(0).light.size.radius_m, 0.1f);
  EXPECT_EQ(frame.lights.at(1).light.size.radius_m, 0.2f);
}

}  // namespace
}  // namespace tempolux
