// tests/lib/scene/scene_at_frame_test.cpp -- surfaces, lights and cameras placed in scene space.
#include <cmath>
#include <stdexcept>

#include "tests/lib/scene/gltf_maker.h"
#include "tests/support/scene_at_frame.h"

namespace tempolux {
namespace {

SceneFrame first_frame(const Scene& scene, const TimeOptions& options = {}) {
  return scene_at_frame(scene, segment_of(scene, 0, options), 0, options);
}

/// Normal of a surface's first triangle by its winding as `flipped` says.
Vec3 facing(const Surface& surface) {
  const auto& t = surface.primitive->triangles[0];
  const Vec3 n = normalize(
      cross(surface.positions[t[1]] - surface.positions[t[0]], surface.positions[t[2]] - surface.positions[t[0]]));
  return surface.flipped ? -n : n;
}

TEST(SceneAtFrame, StaticSurfacesComeFirst) {
  GltfMaker maker;
  maker.add_node({{"mesh", maker.add_square()}});
  maker.add_node({{"mesh", 0}});
  maker.animate(0, "translation", {0, 1}, {0, 0, 0, 1, 0, 0});
  const Scene scene = maker.load();
  const SceneFrame at = first_frame(scene);
  ASSERT_EQ(at.surfaces.size(), 2u);
  EXPECT_EQ(at.static_count, 1u);
  EXPECT_EQ(at.surfaces[0].object, 1u);
  EXPECT_EQ(at.surfaces[1].object, 0u);
}

TEST(SceneAtFrame, AMirroringTransformFlipsTheWindingNotTheFront) {
  GltfMaker maker;
  const int mesh = maker.add_square();  // faces +z
  maker.add_node({{"mesh", mesh}, {"scale", {-2, 1, 1}}});
  maker.add_node({{"mesh", mesh}, {"scale", {1, 1, -1}}});
  maker.add_node({{"mesh", mesh}, {"scale", {-1, -1, 1}}});
  const Scene scene = maker.load();
  const SceneFrame at = first_frame(scene);
  const bool flipped[] = {true, true, false};
  const Vec3 front[] = {{0, 0, 1}, {0, 0, -1}, {0, 0, 1}};
  for (std::size_t s = 0; s < 3; ++s) {
    EXPECT_EQ(at.surfaces[s].flipped, flipped[s]);
    EXPECT_EQ(facing(at.surfaces[s]), front[s]);
    EXPECT_EQ(at.surfaces[s].normals[0], front[s]);
  }
}

TEST(SceneAtFrame, NormalsGoByTheInverseTranspose) {
  GltfMaker maker;
  const float h = std::sqrt(0.5f);
  const int positions = maker.add_vec3({0, 0, 0, 0, 0, 1, 1, -1, 0}),
            normals = maker.add_vec3({h, h, 0, h, h, 0, h, h, 0});
  maker.add_node({{"mesh", maker.add_mesh({{"attributes", {{"POSITION", positions}, {"NORMAL", normals}}}})},
                  {"scale", {1, 2, 1}}});
  const Scene scene = maker.load();
  const SceneFrame at = first_frame(scene);
  // the plane x + y = 0 becomes x + y/2 = 0
  EXPECT_NEAR_VEC(at.surfaces[0].normals[0], (Vec3{2 / std::sqrt(5.0f), 1 / std::sqrt(5.0f), 0}), 1e-7);
  EXPECT_NEAR_VEC(facing(at.surfaces[0]), at.surfaces[0].normals[0], 1e-6);
}

TEST(SceneAtFrame, AFlatScaleLeavesNoNaN) {
  GltfMaker maker;
  const int mesh = maker.add_square();
  maker.add_node({{"mesh", mesh}, {"scale", {0, 0, 0}}});
  maker.add_node({{"mesh", mesh}, {"scale", {1, 1, 0}}});
  const Scene scene = maker.load();
  const SceneFrame at = first_frame(scene);
  for (const Surface& surface : at.surfaces) {
    EXPECT_TRUE(surface.normals.empty());
    for (const Vec3& p : surface.positions) EXPECT_TRUE(is_finite(p));
  }
}

TEST(SceneAtFrame, VerticesBeyondAllNumbersAreRefused) {
  for (const double scale : {1e16, 1e200, 1e308}) {
    GltfMaker maker;
    maker.add_node({{"mesh", maker.add_square()}, {"scale", {scale, scale, scale}}, {"translation", {scale, 0, 0}}});
    const Scene scene = maker.load();
    EXPECT_THROW(first_frame(scene), InputError) << scale;
  }
}

TEST(SceneAtFrame, ALightIsColourTimesIntensityAndItsNodesScaleDoesNotCount) {
  GltfMaker maker;
  maker.add_node({{"mesh", maker.add_triangle()}});
  const float h = std::sqrt(0.5f);
  maker.add_light({{"type", "spot"},
                   {"color", {1, 0.5, 0.25}},
                   {"intensity", 8},
                   {"spot", {{"innerConeAngle", 0.2}, {"outerConeAngle", 0.5}}}},
                  {{"translation", {1, 2, 3}}, {"scale", {7, 7, 7}}, {"rotation", {h, 0, 0, h}}});
  const Scene scene = maker.load();
  const PlacedLight light = first_frame(scene).lights.at(0);
  EXPECT_EQ(light.light.kind, PunctualLight::Kind::spot);
  EXPECT_EQ(light.light.intensity, (Rgb{8, 4, 2}));
  EXPECT_EQ(light.light.inner_cone_rad, 0.2f);
  EXPECT_EQ(light.light.outer_cone_rad, 0.5f);
  EXPECT_EQ(light.position, (Vec3{1, 2, 3}));
  EXPECT_NEAR_VEC(light.direction, (Vec3{0, 1, 0}), 1e-7);  // -z turned by 90 degrees about x
}

TEST(SceneAtFrame, LightUnitsSpecDividesPunctualLightsOnly) {
  GltfMaker maker;
  maker.add_material({{"emissiveFactor", {1, 1, 1}}});
  maker.add_node({{"mesh", maker.add_triangle(0)}});
  maker.add_light({{"type", "directional"}, {"intensity", 683}});
  const Scene scene = maker.load();
  const SceneFrame at = first_frame(scene, {.light_units = "spec"});
  EXPECT_NEAR(at.lights[0].light.intensity.r, 1, 1e-7);
  EXPECT_EQ(at.materials[0].emission, Rgb{1.0f});
  EXPECT_THROW(first_frame(scene, {.light_units = "lumen"}), std::invalid_argument);
}

TEST(SceneAtFrame, ALightWithoutDirectionIsRefused) {
  GltfMaker maker;
  maker.add_node({{"mesh", maker.add_triangle()}});
  maker.add_light({{"type", "directional"}}, {{"scale", {0, 0, 0}}});
  const Scene scene = maker.load();
  EXPECT_THROW(first_frame(scene), InputError);
}

TEST(SceneAtFrame, CamerasAreRigidWhateverTheirScale) {
  GltfMaker maker;
  maker.add_node({{"mesh", maker.add_triangle()}});
  const float h = std::sqrt(0.5f);
  maker.add_camera({{"translation", {1, 2, 3}}, {"rotation", {0, h, 0, h}}, {"scale", {2, 3, 4}}});
  const Scene scene = maker.load();
  const PlacedCamera placed = first_frame(scene).camera(scene.camera_node("auto"));
  EXPECT_EQ(placed.camera.kind, Camera::Kind::perspective);
  EXPECT_EQ(placed.camera.yfov_rad, 0.8);
  const Affine& m = placed.scene_from_camera;
  EXPECT_NEAR_VEC(m.direction({0, 0, -1}), (Vec3d{-1, 0, 0}),
                  1e-7);  // looks along -z, turned 90 degrees about y
  EXPECT_NEAR_VEC(m.direction({1, 0, 0}), (Vec3d{0, 0, -1}), 1e-7);
  EXPECT_NEAR_VEC(m.direction({0, 1, 0}), (Vec3d{0, 1, 0}), 1e-12);
  EXPECT_NEAR(m.determinant(), 1, 1e-12);
  EXPECT_EQ(m.translation, (Vec3d{1, 2, 3}));
}

TEST(SceneAtFrame, LensShiftComesFromTheCamerasExtras) {
  GltfMaker maker;
  maker.add_node({{"mesh", maker.add_triangle()}});
  const int node = maker.add_camera();
  maker.json["cameras"][0]["extras"] = {{"lens_shift", {0.25, -0.5}}, {"other", "text"}};
  EXPECT_EQ(first_frame(maker.load()).camera(node).camera.lens_shift, (std::array{0.25, -0.5}));
  for (const Json& wrong : {Json(1), Json({0.1}), Json({"a", 0}), Json({0, 1e4}), Json({0, 0, 0})}) {
    maker.json["cameras"][0]["extras"]["lens_shift"] = wrong;
    EXPECT_THROW(maker.load(), InputError) << wrong;
  }
  maker.json["cameras"][0]["extras"] = "not an object";
  EXPECT_EQ(first_frame(maker.load()).camera(node).camera.lens_shift, (std::array{0.0, 0.0}));
}

TEST(SceneAtFrame, LensAndShutterComeFromTheNodesExtras) {
  GltfMaker maker;
  maker.add_node({{"mesh", maker.add_triangle()}});
  const int node = maker.add_camera({{"extras",
                                      {{"lens_mm", 50},
                                       {"f_stop", {2.5, 5, 10}},
                                       {"first_frame", 3},
                                       {"focus_m", 4},
                                       {"shutter_frames", 0.5},
                                       {"shutter_position", "start"}}}});
  const Scene scene = maker.load();
  EXPECT_TRUE(scene.warnings.empty());
  const auto camera_at = [&](int frame) {
    Camera camera = scene.cameras[0];
    scene.nodes[std::size_t(node)].camera_extras.apply(frame, camera);
    return camera;
  };
  // Before and behind the list its ends hold.
  EXPECT_EQ(camera_at(0).f_stop, 2.5);
  EXPECT_EQ(camera_at(3).f_stop, 2.5);
  EXPECT_EQ(camera_at(4).f_stop, 5);
  EXPECT_EQ(camera_at(9).f_stop, 10);
  EXPECT_EQ(camera_at(4).lens_mm, 50);
  EXPECT_EQ(camera_at(4).focus_m, 4);
  EXPECT_EQ(camera_at(4).shutter_frames, 0.5);
  EXPECT_EQ(camera_at(4).shutter, Camera::Shutter::start);

  maker.json["nodes"][node]["extras"] = {{"f_stop", -1}, {"lens_mm", "long"}, {"shutter_position", 2}, {"focus_m", {}}};
  EXPECT_EQ(maker.load().warnings.size(), 3u);  // {} is null: the file does not say
}

/// What records and decisions depend on knows nothing of the lens; the picture does, once the lens is open.
TEST(SceneAtFrame, AnEditOfTheLensChangesPicturesOnly) {
  PlacedCamera sharp, blurred, refocused;
  blurred.camera.f_stop = refocused.camera.f_stop = 2;
  sharp.camera.focus_m = blurred.camera.focus_m = 3;
  EXPECT_EQ(pinhole_hash(sharp), pinhole_hash(blurred));
  EXPECT_NE(camera_hash(sharp), camera_hash(blurred));
  EXPECT_NE(camera_hash(refocused), camera_hash(blurred));
  PlacedCamera other = sharp;
  other.camera.focus_m = 5;  // of a pinhole
  EXPECT_EQ(camera_hash(other), camera_hash(sharp));
}

/// The distance of a node that moves: along the view axis.
TEST(SceneAtFrame, FocusFollowsANode) {
  GltfMaker maker;
  const int target = maker.add_node({{"mesh", maker.add_triangle()}});
  const int node = maker.add_camera({{"name", "Camera"}});
  maker.animate(target, "translation", {0, 1}, {3, 0, -4, 3, 0, -28});
  Scene scene = maker.load();
  scene.nodes[std::size_t(node)].camera_extras.focus_node = target;
  const SegmentScene segment(scene, segment_of(scene, 0, {}), {});
  EXPECT_NEAR(segment.at(0).camera(node).camera.focus_m, 4, 1e-12);
  EXPECT_NEAR(segment.at(12).camera(node).camera.focus_m, 16, 1e-12);
}

TEST(SceneAtFrame, BetweenTwoFramesIsBetweenTheirStates) {
  GltfMaker maker;
  maker.add_node({{"mesh", maker.add_triangle()}});
  const int node = maker.add_camera({{"name", "Camera"}});
  maker.animate(node, "translation", {0, 1}, {0, 0, 0, 24, 0, 0});
  const Scene scene = maker.load();
  const SegmentScene segment(scene, segment_of(scene, 0, {}), {});
  EXPECT_EQ(segment.at(12).camera(node).scene_from_camera.translation.x, 12);
  EXPECT_EQ(segment.at(12.25).camera(node).scene_from_camera.translation.x, 12.25);
  EXPECT_EQ(segment.at(12.25).frame, 12);
  EXPECT_THROW(segment.at(-0.25), std::invalid_argument);
}

TEST(SceneAtFrame, OrthographicCamerasKeepTheirHeight) {
  GltfMaker maker;
  maker.add_node({{"mesh", maker.add_triangle()}});
  const int node = maker.add_camera();
  maker.json["cameras"][0] = {{"type", "orthographic"},
                              {"orthographic", {{"xmag", 3}, {"ymag", 1.5}, {"znear", 0.01}, {"zfar", 9}}}};
  const Scene scene = maker.load();
  const PlacedCamera placed = first_frame(scene).camera(node);
  EXPECT_EQ(placed.camera.kind, Camera::Kind::orthographic);
  EXPECT_EQ(placed.camera.ymag_m, 1.5);
  EXPECT_THROW(first_frame(scene).camera(0), std::invalid_argument);
}

TEST(SceneAtFrame, AMovingLightIsPlacedAtTheFrame) {
  if (shared_scenes().empty()) GTEST_SKIP() << "../shared/scenes is not there";
  const Scene scene = load_gltf((shared_scenes() / "made/S5_moving_light.glb").string());
  const SegmentScene stage(scene, segment_of(scene, 0, {}), {});
  const SceneFrame a = stage.at(0), b = stage.at(10);
  ASSERT_EQ(a.lights.size(), 2u);
  EXPECT_EQ(a.static_count, a.surfaces.size());
  int moved = 0;
  for (std::size_t i = 0; i < 2; ++i) moved += a.lights[i].position != b.lights[i].position;
  EXPECT_EQ(moved, 1);
  EXPECT_NE(a.hashes.lights, b.hashes.lights);
  EXPECT_EQ(a.hashes.moving_geometry, b.hashes.moving_geometry);
}

}  // namespace
}  // namespace tempolux
