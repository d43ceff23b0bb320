// tests/lib/scene/scene_deform_test.cpp -- morphed and skinned meshes, instances, properties that pointers animate:
// against values worked out on paper.
#include <cmath>
#include <numbers>
#include <set>

#include "lib/light/lights.h"
#include "lib/scene/animate.h"
#include "tests/lib/scene/gltf_maker.h"
#include "tests/support/scene_at_frame.h"

namespace tempolux {
namespace {

// One rounding of a coordinate below 4 m from float32 keys.
constexpr double kRounding = 5e-7;

SceneFrame frame_of(const Scene& scene, int frame) {
  return scene_at_frame(scene, segment_of(scene, frame, {}), frame, {});
}

/// A square whose two upper corners a first target lifts by (0,0,1) and a second moves by (2,0,0); normals of the
/// first target lean to +y.
GltfMaker morph(bool normals = true) {
  GltfMaker maker;
  const int mesh = maker.add_square();
  Json first = {{"POSITION", maker.add_vec3({0, 0, 0, 0, 0, 0, 0, 0, 1, 0, 0, 1})}};
  if (normals) first["NORMAL"] = maker.add_vec3({0, 0, 0, 0, 0, 0, 0, 1, 0, 0, 1, 0});
  const Json second = {{"POSITION", maker.add_vec3({0, 0, 0, 0, 0, 0, 2, 0, 0, 2, 0, 0})}};
  maker.json["meshes"][0]["primitives"][0]["targets"] = {first, second};
  maker.add_node({{"mesh", mesh}});
  return maker;
}

void animate_weights(GltfMaker& maker, const std::vector<float>& times, const std::vector<float>& values,
                     const char* how = "LINEAR") {
  maker.animate(0, "translation", times, std::vector<float>(times.size() * 3, 0));
  Json& animation = maker.json["animations"][0];
  animation["samplers"][0]["output"] = maker.add_scalars(values);
  animation["samplers"][0]["interpolation"] = how;
  animation["channels"][0]["target"]["path"] = "weights";
}

TEST(Morph, TargetsAddTheirDisplacementsTimesTheWeightsAtTheFrame) {
  GltfMaker maker = morph();
  animate_weights(maker, {0, 1}, {0, 1, 1, 0});  // first 0 -> 1, second 1 -> 0
  const Scene scene = maker.load();
  for (const int frame : {0, 6, 12, 24}) {
    const float s = float(frame) / 24;
    const SceneFrame at = frame_of(scene, frame);
    EXPECT_NEAR_VEC(at.surfaces[0].position(2), (Vec3{1 + 2 * (1 - s), 1, s}), kRounding);
    EXPECT_NEAR_VEC(at.surfaces[0].position(0), (Vec3{0, 0, 0}), 0);
    EXPECT_NEAR_VEC(at.surfaces[0].normal(2), normalize(Vec3{0, s, 1}), kRounding);
  }
}

TEST(Morph, WeightsStepAndFollowSplinesComponentByComponent) {
  GltfMaker step = morph(), spline = morph();
  animate_weights(step, {0, 0.5f}, {0, 0, 1, 0.5f}, "STEP");
  const Scene stepped = step.load();
  EXPECT_EQ(frame_of(stepped, 11).surfaces[0].position(2), (Vec3{1, 1, 0}));
  EXPECT_EQ(frame_of(stepped, 12).surfaces[0].position(2), (Vec3{2, 1, 1}));
  // in-tangents, values, out-tangents of both targets per key: v = 0 -> 1 with out0 = 4, in1 = 2 over 2 s:
  // at half 0.5 + 2 (4 - 2) / 8 = 1 of the first; the second has no tangents: 1/2 of the way.
  animate_weights(spline, {0, 2}, {9, 9, 0, 0, 4, 0, 2, 0, 1, 1, 9, 9}, "CUBICSPLINE");
  EXPECT_NEAR_VEC(frame_of(spline.load(), 24).surfaces[0].position(2), (Vec3{2, 1, 1}), kRounding);
}

TEST(Morph, WeightsAtRestAreTheNodesElseTheMeshs) {
  GltfMaker maker = morph();
  maker.json["meshes"][0]["weights"] = {0.5, 0};
  EXPECT_EQ(frame_of(maker.load(), 0).surfaces[0].position(2), (Vec3{1, 1, 0.5f}));
  maker.json["nodes"][0]["weights"] = {0, 0.25};
  EXPECT_EQ(frame_of(maker.load(), 0).surfaces[0].position(2), (Vec3{1.5f, 1, 0}));
  maker.json["nodes"][0]["weights"] = {1};
  const Scene few = maker.load();
  EXPECT_TRUE(has_warning(few, "nodes[0].weights: 1 weights for 2 morph targets are left out"));
  EXPECT_EQ(frame_of(few, 0).surfaces[0].position(2), (Vec3{1, 1, 0}));
}

TEST(Morph, MovesOnlyWhereItsWeightsDiffer) {
  GltfMaker maker = morph();
  animate_weights(maker, {0, 1, 2, 4}, {0, 0, 0, 0, 1, 0, 1, 0});
  const Scene scene = maker.load();
  EXPECT_EQ(segment_of(scene, 0, {}).node_moves[0], 0);
  const Segment middle = segment_of(scene, 30, {});
  EXPECT_EQ(middle.node_moves[0], 1);
  EXPECT_EQ(middle.why_moves[0], "weights of node 0");
  EXPECT_EQ(segment_of(scene, 72, {}).node_moves[0], 0);
  // bounds of the middle segment hold the shape at all its frames
  for (int f = middle.first; f <= middle.last; ++f)
    for (std::uint32_t v = 0; v < 4; ++v)
      EXPECT_LE(double(frame_of(scene, f).surfaces[0].position(v).z), middle.world_bounds.upper.z);
  EXPECT_NE(frame_of(scene, 30).hashes.moving_geometry, frame_of(scene, 31).hashes.moving_geometry);
}

/// A quad between two joints: corners 0 and 1 follow joint A; corners 2 and 3 follow B with the weight `share` and A
/// with the rest. The mesh's own node has another transform, which must have no effect.
GltfMaker skin(float share, bool second_set = false) {
  GltfMaker maker;
  const int mesh = maker.add_square();
  Json& attributes = maker.json["meshes"][0]["primitives"][0]["attributes"];
  const std::vector<std::uint16_t> joints(
      second_set ? std::vector<std::uint16_t>(16, 0)
                 : std::vector<std::uint16_t>{0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0});
  const float r = 1 - share;
  attributes["JOINTS_0"] = maker.add_accessor(joints, 5123, "VEC4", 4);
  if (second_set) {
    attributes["WEIGHTS_0"] = maker.add_vec4({1, 0, 0, 0, 1, 0, 0, 0, r, 0, 0, 0, r, 0, 0, 0});
    attributes["JOINTS_1"] = maker.add_accessor(std::vector<std::uint8_t>(16, 1), 5121, "VEC4", 4);
    attributes["WEIGHTS_1"] = maker.add_vec4({0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, share, 0, 0, 0, share});
  } else {
    attributes["WEIGHTS_0"] = maker.add_vec4({1, 0, 0, 0, 1, 0, 0, 0, r, share, 0, 0, r, share, 0, 0});
  }
  maker.add_node({{"mesh", mesh}, {"skin", 0}, {"translation", {100, 200, 300}}});
  const int b = maker.add_node({{"name", "B"}, {"translation", {0, 1, 0}}}, false);
  const int a = maker.add_node({{"name", "A"}, {"children", {b}}, {"translation", {0, 0, 2}}});
  // inverse bind: A was at (0,0,0), B at (0,1,0)
  const int matrices = maker.add_accessor(std::vector<float>{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0,  0, 1,
                                                             1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, -1, 0, 1},
                                          5126, "MAT4", 16);
  maker.json["skins"] = {{{"joints", {a, b}}, {"inverseBindMatrices", matrices}}};
  return maker;
}

TEST(Skin, VerticesFollowTheirJointsAndNotTheirNode) {
  for (const bool second_set : {false, true}) {
    GltfMaker maker = skin(0.75f, second_set);
    const float h = std::sqrt(0.5f);
    maker.animate(1, "rotation", {0, 1}, {0, 0, 0, 1, h, 0, 0, h});  // B turns a quarter about x
    const Scene scene = maker.load();
    for (const int frame : {0, 8, 24}) {
      // B stands at (0,1,2): corner 2 = (1,1,0) is at (1,0,0) of it, on the axis: stays at (1,1,2)
      const SceneFrame at = frame_of(scene, frame);
      EXPECT_NEAR_VEC(at.surfaces[0].position(2), (Vec3{1, 1, 2}), kRounding);
      EXPECT_NEAR_VEC(at.surfaces[0].position(0), (Vec3{0, 0, 2}), kRounding);
      // normals of corner 2: inverse transpose of M = 1/4 A + 3/4 B, B turned by a about x: M's 2x2 block in y, z is
      // [p -q; q p] with p = 1/4 + 3/4 cos a, q = 3/4 sin a: a rotation times a scale, so n = (0, -q, p) made unit
      const double a = std::numbers::pi / 2 * std::min(frame, 24) / 24, p = 0.25 + 0.75 * std::cos(a),
                   q = 0.75 * std::sin(a);
      EXPECT_NEAR_VEC(at.surfaces[0].normal(2), Vec3(normalize(Vec3d{0, -q, p})), kRounding);
    }
    EXPECT_EQ(segment_of(scene, 0, {}).node_moves[0], 1);
    EXPECT_EQ(segment_of(scene, 0, {}).why_moves[0], "joint B");
    EXPECT_LT(segment_of(scene, 0, {}).world_bounds.diagonal(), 4);  // and not at (100, 200, 300)
  }
}

TEST(Skin, NormalsGoByTheInverseTranspose) {
  // A scales by (2,1,1) and the plane is x + z = 0 turned: normal (1,0,1) becomes (1/2,0,1).
  GltfMaker maker = skin(0);
  maker.json["meshes"][0]["primitives"][0]["attributes"]["NORMAL"] =
      maker.add_vec3({1, 0, 1, 1, 0, 1, 1, 0, 1, 1, 0, 1});
  maker.json["nodes"][2]["scale"] = {2, 1, 1};
  const SceneFrame at = frame_of(maker.load(), 0);
  EXPECT_NEAR_VEC(at.surfaces[0].normal(0), normalize(Vec3{0.5f, 0, 1}), kRounding);
  EXPECT_NEAR_VEC(at.surfaces[0].position(1), (Vec3{2, 0, 2}), kRounding);
}

TEST(Skin, AMovingNodeWhoseJointsRestStandsStill) {
  GltfMaker maker = skin(0.5f);
  maker.animate(0, "translation", {0, 1}, {0, 0, 0, 9, 9, 9});
  const Scene scene = maker.load();
  const Segment segment = segment_of(scene, 0, {});
  EXPECT_EQ(segment.node_moves[0], 0);
  EXPECT_EQ(frame_of(scene, 0).surfaces[0].position(0), frame_of(scene, 20).surfaces[0].position(0));
  // a joint that no vertex follows does not move the mesh either
  GltfMaker unused = skin(0);
  unused.animate(1, "translation", {0, 1}, {0, 1, 0, 0, 5, 0});
  EXPECT_EQ(segment_of(unused.load(), 0, {}).node_moves[0], 0);
}

TEST(Skin, MirroringJointsTurnTheFront) {
  GltfMaker maker = skin(0.5f);
  EXPECT_FALSE(frame_of(maker.load(), 0).surfaces[0].flipped);
  maker.json["nodes"][2]["scale"] = {-1, 1, 1};
  const SceneFrame at = frame_of(maker.load(), 0);
  EXPECT_TRUE(at.surfaces[0].flipped);
  EXPECT_NEAR_VEC(at.surfaces[0].normal(0), (Vec3{0, 0, 1}), kRounding);
}

TEST(Skin, WhatCannotBeRightIsRefused) {
  GltfMaker no_joint = skin(0.5f), few = skin(0.5f), outside = skin(0.5f);
  no_joint.json["skins"][0]["joints"] = {99};
  EXPECT_CONTAINS(load_error(write_file("s.gltf", no_joint.text())), "skins[0].joints: node 99 is not in the scene");
  few.json["skins"][0]["joints"] = {2};
  EXPECT_CONTAINS(load_error(write_file("s.gltf", few.text())), "names joint 1, but its skin has 1");
  outside.json["nodes"][0]["skin"] = 7;
  EXPECT_TRUE(has_warning(outside.load(), "skin 7 does not exist; the mesh stays rigid"));
}

TEST(Emission, TheTableIsTheMaximumOverADeformingEmitter) {
  GltfMaker maker;
  maker.add_material({{"emissiveFactor", {1, 1, 1}}});
  const int mesh = maker.add_square(0);
  maker.json["meshes"][0]["primitives"][0]["targets"] = {
      {{"POSITION", maker.add_vec3({0, 0, 0, 3, 0, 0, 3, 0, 0, 0, 0, 0})}}};
  maker.add_node({{"mesh", mesh}});
  maker.add_node({{"mesh", maker.add_square(0)}, {"translation", {0, 9, 0}}});
  animate_weights(maker, {0, 12 / 24.0f, 1}, {0, 1, 0});  // widest, 4 m x 1 m, at frame 12
  const Scene scene = maker.load();
  const EmissionTable table = build_emission_table(scene, segment_of(scene, 0, {}), {});
  // the still square (first, 1 m^2) against the other at its largest (4 m^2)
  EXPECT_NEAR(table.probability[0] + table.probability[1], 1.0 / 5, 1e-6);
}

// ---- instances ------------------------------------------------------------------------------------------------

TEST(Instances, StandWhereTheirAttributesSay) {
  GltfMaker maker;
  const int mesh = maker.add_triangle();
  const float h = std::sqrt(0.5f);
  const Json attributes = {{"TRANSLATION", maker.add_vec3({1, 0, 0, 0, 5, 0})},
                           {"ROTATION", maker.add_vec4({0, 0, 0, 1, 0, 0, h, h})},
                           {"SCALE", maker.add_vec3({1, 1, 1, 2, 2, 2})}};
  maker.add_node({{"mesh", mesh},
                  {"translation", {0, 0, 7}},
                  {"extensions", {{"EXT_mesh_gpu_instancing", {{"attributes", attributes}}}}}});
  const Scene scene = maker.load();
  const SceneFrame at = frame_of(scene, 0);
  ASSERT_EQ(at.surfaces.size(), 2u);
  EXPECT_EQ(at.surfaces[0].position(1), (Vec3{2, 0, 7}));
  // (1,0,0) scaled to (2,0,0), turned a quarter about z to (0,2,0), moved
  EXPECT_NEAR_VEC(at.surfaces[1].position(1), (Vec3{0, 7, 7}), 1e-6);
  EXPECT_EQ(at.surfaces[1].object, 0u);
  EXPECT_EQ(at.bounds.upper, (Vec3{2, 7, 7}));
  GltfMaker unequal = maker;
  unequal.json["nodes"][0]["extensions"]["EXT_mesh_gpu_instancing"]["attributes"]["SCALE"] =
      unequal.add_vec3({1, 1, 1});
  EXPECT_CONTAINS(load_error(write_file("i.gltf", unequal.text())), "its attributes have different counts");
}

// ---- KHR_animation_pointer ----------------------------------------------------------------------------------------

void point_at(GltfMaker& maker, const std::string& pointer, const std::vector<float>& times,
              const std::vector<float>& values, int components) {
  if (!maker.json.contains("animations"))
    maker.json["animations"] = {{{"channels", Json::array()}, {"samplers", Json::array()}}};
  const int output = components == 4   ? maker.add_vec4(values)
                     : components == 3 ? maker.add_vec3(values)
                                       : maker.add_scalars(values);
  Json& animation = maker.json["animations"][0];
  animation["samplers"].push_back({{"input", maker.add_scalars(times)}, {"output", output}});
  animation["channels"].push_back(
      {{"sampler", animation["samplers"].size() - 1},
       {"target", {{"path", "pointer"}, {"extensions", {{"KHR_animation_pointer", {{"pointer", pointer}}}}}}}});
}

GltfMaker lit_square() {
  GltfMaker maker;
  maker.add_material({{"name", "Paint"},
                      {"emissiveFactor", {0.5, 0.25, 0}},
                      {"extensions", {{"KHR_materials_emissive_strength", {{"emissiveStrength", 2}}}}}});
  maker.add_node({{"mesh", maker.add_square(0)}});
  maker.add_light({{"name", "Lamp"},
                   {"type", "spot"},
                   {"intensity", 10},
                   {"color", {1, 0.5, 0.25}},
                   {"spot", {{"innerConeAngle", 0.1}, {"outerConeAngle", 0.5}}}});
  maker.add_camera();
  return maker;
}

TEST(Pointers, MaterialsLightsAndCamerasAreEvaluatedAtTheFrame) {
  GltfMaker maker = lit_square();
  point_at(maker, "/materials/0/pbrMetallicRoughness/baseColorFactor", {0, 1}, {0, 0, 0, 1, 1, 0.5f, 0.25f, 1}, 4);
  point_at(maker, "/materials/0/extensions/KHR_materials_emissive_strength/emissiveStrength", {0, 1}, {2, 4}, 1);
  point_at(maker, "/extensions/KHR_lights_punctual/lights/0/intensity", {0, 1}, {10, 20}, 1);
  point_at(maker, "/extensions/KHR_lights_punctual/lights/0/spot/outerConeAngle", {0, 1}, {0.5f, 1}, 1);
  point_at(maker, "/cameras/0/perspective/yfov", {0, 1}, {0.8f, 0.4f}, 1);
  point_at(maker, "/nodes/0/translation", {0, 1}, {0, 0, 0, 0, 0, 2}, 3);
  const Scene scene = maker.load();
  EXPECT_TRUE(scene.warnings.empty());
  const SceneFrame a = frame_of(scene, 0), b = frame_of(scene, 12);
  EXPECT_NEAR(b.materials[0].base_color.r, 0.5, 1e-7);
  EXPECT_NEAR(b.materials[0].base_color.b, 0.125, 1e-7);
  EXPECT_NEAR(b.materials[0].emission.r, 1.5, 1e-6);  // 0.5 x 3: the factor rests, the strength is halfway
  EXPECT_NEAR(b.lights[0].light.intensity.g, 7.5, 1e-5);
  EXPECT_NEAR(b.lights[0].light.outer_cone_rad, 0.75, 1e-6);
  EXPECT_NEAR(b.lights[0].light.inner_cone_rad, 0.1, 1e-6);
  EXPECT_NEAR(b.camera(scene.camera_node("auto")).camera.yfov_rad, 0.6, 1e-6);
  EXPECT_EQ(b.surfaces[0].position(0).z, 1);
  EXPECT_NE(a.hashes.materials, b.hashes.materials);
  EXPECT_NE(a.hashes.lights, b.hashes.lights);
  EXPECT_NE(a.hashes.camera, b.hashes.camera);
  std::set<std::string> why;
  for (const PropertyChange& change : a.segment.changes) why.insert(change.why);
  EXPECT_TRUE(why.contains("base colour of Paint") && why.contains("intensity of Lamp") &&
              why.contains("yfov of camera 0"));
}

TEST(Pointers, ALampThatFlaresUpKeepsTheProbabilityOfItsMaximum) {
  GltfMaker maker = lit_square();
  maker.json["materials"][0].erase("emissiveFactor");
  maker.json["extensions"]["KHR_lights_punctual"]["lights"] = {{{"type", "point"}, {"intensity", 1}},
                                                               {{"type", "point"}, {"intensity", 1}}};
  maker.add_node({{"extensions", {{"KHR_lights_punctual", {{"light", 1}}}}}});
  point_at(maker, "/extensions/KHR_lights_punctual/lights/0/intensity", {0, 0.5f, 1}, {1, 9, 1}, 1);
  const Scene scene = maker.load();
  const EmissionTable table = build_emission_table(scene, segment_of(scene, 0, {}), {});
  ASSERT_EQ(table.probability.size(), 2u);
  EXPECT_NEAR(table.probability[0], 0.9, 1e-6);
}

TEST(Pointers, WhatIsNotAnimatedAndWhatDoesNotExistIsNamedAndLeftOut) {
  GltfMaker maker = lit_square();
  point_at(maker, "/materials/0/normalTexture/scale", {0, 1}, {0, 1}, 1);
  EXPECT_TRUE(has_warning(maker.load(), "ignored: animation of /materials/0/normalTexture/scale"));
  GltfMaker missing = lit_square();
  point_at(missing, "/materials/7/alphaCutoff", {0, 1}, {0, 1}, 1);
  EXPECT_TRUE(has_warning(missing.load(), "pointer /materials/7/alphaCutoff: there is no such object"));
}

TEST(Pointers, AMaterialThatIsDarkAtRestCountsAsALight) {
  GltfMaker maker;
  maker.add_material({{"name", "Screen"}});
  maker.add_node({{"mesh", maker.add_square(0)}});
  EXPECT_THROW(require_lights(maker.load()), InputError);
  point_at(maker, "/materials/0/emissiveFactor", {0, 1}, {0, 0, 0, 1, 1, 1}, 3);
  EXPECT_NO_THROW(require_lights(maker.load()));
}

}  // namespace
}  // namespace tempolux
