// tests/lib/render/deforming_motion_test.cpp -- motion of points on deforming surfaces, against the closed form.
#include "lib/render/data_channels.h"
#include "tests/lib/scene/gltf_maker.h"
#include "tests/support/scene_at_frame.h"

namespace tempolux {
namespace {

/// A unit square that a morph target shears: x' = x + w y, w = frame / 24, seen by an orthographic camera of 20
/// pixels per metre. A point at height y goes 20 y / 24 pixels to the right per frame, and came from as far left.
TEST(DeformingMotion, FollowsTheShearOfAMorphTarget) {
  GltfMaker maker;
  const int mesh = maker.add_square();
  maker.json["meshes"][0]["primitives"][0]["targets"] = {
      {{"POSITION", maker.add_vec3({0, 0, 0, 0, 0, 0, 1, 0, 0, 1, 0, 0})}}};
  maker.add_node({{"mesh", mesh}});
  const int camera = maker.add_camera({{"translation", {1, 0.5, 3}}});
  maker.json["cameras"][0] = {{"type", "orthographic"},
                              {"orthographic", {{"xmag", 1}, {"ymag", 1}, {"znear", 0.01}, {"zfar", 9}}}};
  maker.animate(0, "translation", {0, 1}, {0, 0, 0, 0, 0, 0});
  maker.json["animations"][0]["samplers"][0]["output"] = maker.add_scalars({0, 1});
  maker.json["animations"][0]["channels"][0]["target"]["path"] = "weights";
  const Scene scene = maker.load();
  const Segment segment = segment_of(scene, 8, {});
  const SceneFrame now = scene_at_frame(scene, segment, 8, {}), later = scene_at_frame(scene, segment, 9, {}),
                   earlier = scene_at_frame(scene, segment, 7, {});
  const CameraView view(now.camera(camera), now.origin, 40, 40);
  const EmissionTable table = build_emission_table(scene, segment, {});
  const Lights lights(now, table);
  const Tracer tracer(now);
  Image image{40, 40, {}, {}, {}, {}};
  add_data_channels({tracer, lights}, view, {"P", "Z", "motion"}, {&later, &view}, {&earlier, &view}, image);
  int seen = 0;
  for (std::size_t p = 0; p < image.pixel_count(); ++p) {
    if (std::isinf(image.find("Z")->values[p])) continue;
    ++seen;
    const double y = double(image.find("P.Y")->values[p]), step = 20 * y / 24;
    EXPECT_NEAR(image.find("forward.u")->values[p], step, 1e-4);
    EXPECT_NEAR(image.find("backward.u")->values[p], -step, 1e-4);
    EXPECT_NEAR(image.find("forward.v")->values[p], 0, 1e-4);
  }
  EXPECT_NEAR(seen, 400, 25);  // 1 m^2 of 20 x 20 pixels, sheared
}

}  // namespace
}  // namespace tempolux
