// Motion blur against formulas on paper: what moves is seen for the share of time that it is there.
#include "lib/render/shutter.h"

#include <cmath>

#include "lib/render/feature_means.h"
#include "lib/render/data_channels.h"
#include "lib/render/frame_renderer.h"
#include "lib/scene/camera_extras.h"
#include "lib/scene/centre_shutter.h"
#include "tests/lib/scene/gltf_maker.h"
#include "tests/support/sliding_edge.h"

namespace tempolux {
namespace {

using test::expected_column;

/// A film by an orthographic camera at (1, .5, 3), 40 x 20 pixels of 1/20 m.
struct Film {
  GltfMaker maker;
  int camera = -1;
  double shutter_frames = 0.5;
  double lens_radius_m = 0;  ///< focused at 2 m
  Camera::Shutter position = Camera::Shutter::centre;

  int add_glowing_square(const Json& node = Json::object()) {
    Json with = node;
    with["mesh"] = maker.add_square(maker.add_material(
        {{"emissiveFactor", {1, 1, 1}}, {"pbrMetallicRoughness", {{"baseColorFactor", {0, 0, 0, 1}}}}}));
    return maker.add_node(with);
  }
  void add_camera() {
    camera = maker.add_camera({{"translation", {1, 0.5, 3}}});
    maker.json["cameras"][0] = {{"type", "orthographic"},
                                {"orthographic", {{"xmag", 1}, {"ymag", 0.5}, {"znear", 0.01}, {"zfar", 9}}}};
  }
  /// Calls body(shutter or nullptr, scene, view) with the film's frame 1.
  template <class Body>
  void at_frame_1(const Body& body) const {
    const Scene scene = with_shutter();
    const Segment segment = segment_of(scene, 1, {});
    const SceneFrame frame = SegmentScene(scene, segment, {}).at(1);
    const Tracer tracer(frame);
    const Lights lights(frame, build_emission_table(scene, segment, {}));
    const RenderScene lit{tracer, lights};
    const CameraView view(frame, camera, 40, 20);
    const TimeOptions time;
    const auto shutter = Shutter::of({scene, time, camera, lit, view});
    body(shutter.get(), lit, view);
  }
  RenderedFrame rendered(int samples) const {
    RenderedFrame picture;
    at_frame_1([&](const Shutter* shutter, const RenderScene& lit, const CameraView& view) {
      FrameOptions options;
      options.samples = samples;
      options.mask.assign(800, 0);
      std::fill(options.mask.begin() + 40, options.mask.end() - 40, 1);
      options.shutter = shutter;
      picture = render_frame(lit, view, options);
    });
    return picture;
  }

 private:
  Scene with_shutter() const {
    Scene scene = maker.load();
    CameraExtras& extras = scene.nodes[std::size_t(camera)].camera_extras;
    extras.set(&Camera::shutter_frames, shutter_frames);
    extras.set(&Camera::lens_radius_m, lens_radius_m);
    extras.set(&Camera::focus_m, 2);
    set_shutter_position(extras, position);
    centre_shutter(scene, extras, TimeOptions{}.fps);
    return scene;
  }
};

/// Mean over rows 4 to 15 of a column.
double column(const RenderedFrame& frame, int x) {
  double sum = 0;
  for (int y = 4; y < 16; ++y) sum += radiance_of(frame.mean.pixels[std::size_t(40 * y + x)]);
  return sum / 12;
}

/// Over 12 rows of 4096 samples the standard error of a column is below .0025, that of independent samples.
constexpr double kOff = 0.003;

/// A square that slides by 8 pixels a frame, with the shutter open for half of it: its edges are ramps of 4 pixels
/// around their places. 1 m is 20 pixels; at frame 1 the square's left edge is at x = .4 m. Meant to catch: a shutter
/// that opens at the frame's time.
TEST(Shutter, ASlidingEdgeIsARamp) {
  Film film;
  const int square = film.add_glowing_square();
  film.add_camera();
  film.maker.animate(square, "translation", {0, 1 / 12.0f}, {0, 0, 0, 0.8f, 0, 0});
  const RenderedFrame frame = film.rendered(4096);
  for (int x = 2; x < 38; ++x) EXPECT_NEAR(column(frame, x), expected_column(8, 28, 4, x), kOff) << x;
}

/// A shutter that opens at the frame's time shows the same ramps 2 pixels ahead, one that closes then 2 pixels behind;
/// stored light belongs to the middle. Meant to catch: keys that are moved the other way, or by the whole open time.
TEST(Shutter, StoredLightBelongsToTheMiddleWhereverItOpens) {
  for (const auto& [position, by] : {std::pair{Camera::Shutter::start, 2.0}, {Camera::Shutter::end, -2.0}}) {
    Film film;
    film.position = position;
    const int square = film.add_glowing_square();
    film.add_camera();
    film.maker.animate(square, "translation", {0, 1 / 12.0f}, {0, 0, 0, 0.8f, 0, 0});
    const RenderedFrame frame = film.rendered(4096);
    for (int x = 2; x < 38; ++x) EXPECT_NEAR(column(frame, x), expected_column(8 + by, 28 + by, 4, x), kOff) << x;
    film.at_frame_1([&](const Shutter* shutter, const RenderScene& lit, const CameraView&) {
      ASSERT_NE(shutter, nullptr);
      EXPECT_NEAR(lit.tracer.surface_point({0, 0, 0, 0, 0}).position.x, 0.4 + by / 20, 1e-5);  // keys are float32
    });
  }
}

/// The same if the camera slides in the other direction.
TEST(Shutter, AMovingCameraBlursWhatStands) {
  Film film;
  film.add_glowing_square({{"translation", {0.4, 0, 0}}});
  film.add_camera();
  film.maker.animate(film.camera, "translation", {0, 1 / 12.0f}, {1.4f, 0.5f, 3, 0.6f, 0.5f, 3});
  const RenderedFrame frame = film.rendered(4096);
  for (int x = 2; x < 38; ++x) EXPECT_NEAR(column(frame, x), expected_column(8, 28, 4, x), kOff) << x;
}

/// A square of side 2a that turns once in each frame, with the shutter always open: at distance r from its axis it is
/// there for 1 - 4 / pi acos(a / r) of the time. At whole frames nothing has moved. Meant to catch: movers that are
/// looked for at whole frames only.
TEST(Shutter, ASpinningWheelIsARing) {
  Film film;
  film.shutter_frames = 1;
  const int square = film.add_glowing_square({{"translation", {-0.3, -0.3, 0}}, {"scale", {0.6, 0.6, 1}}});
  film.maker.json["scenes"][0]["nodes"].clear();
  const int axis = film.maker.add_node({{"translation", {1, 0.5, 0}}, {"children", {square}}});
  film.add_camera();
  std::vector<float> times, turns;
  for (int quarter = 0; quarter <= 12; ++quarter) {
    times.push_back(float(quarter) / 96);
    const double half = M_PI / 4 * quarter;
    turns.insert(turns.end(), {0, 0, float(std::sin(half)), float(std::cos(half))});
  }
  film.maker.animate(axis, "rotation", times, turns);
  const RenderedFrame frame = film.rendered(512);
  double seen = 0, expected = 0;
  for (int y = 1; y < 19; ++y)
    for (int x = 0; x < 40; ++x) {
      const double r = std::hypot(x + 0.5 - 20, y + 0.5 - 10);
      if (r < 6.5 || r > 8) continue;
      seen += radiance_of(frame.mean.pixels[std::size_t(40 * y + x)]);
      for (int i = 0; i < 16; ++i)
        for (int j = 0; j < 16; ++j) {
          const double at = std::hypot(x + (i + 0.5) / 16 - 20, y + (j + 0.5) / 16 - 10);
          expected += (at > 6 * M_SQRT2 ? 0 : at < 6 ? 1 : 1 - 4 / M_PI * std::acos(6 / at)) / 256;
        }
    }
  EXPECT_NEAR(seen, expected, 0.003 * expected);
}

/// A lamp that is switched on while the shutter is open gives the share of light that remains. At frame 1 the shutter
/// is open from 1/32 to 5/96 s; the lamp goes on at 3/8 of that time.
TEST(Shutter, ALampThatFlashesGivesItsShareOfTheTime) {
  const auto light_of = [](std::vector<float> intensities) {
    Film film;
    film.maker.add_node({{"mesh", film.maker.add_square()}, {"scale", {2, 1, 1}}});
    film.maker.add_light({{"type", "point"}, {"intensity", 1}}, {{"translation", {1, 0.5, 1}}});
    film.add_camera();
    film.maker.animate(0, "translation", {0, 1 / 32.0f + 3 / 8.0f / 48}, {0, 0, 0, 0, 0, 0}, "STEP");
    Json& animation = film.maker.json["animations"][0];
    animation["samplers"][0]["output"] = film.maker.add_scalars(intensities);
    animation["channels"][0]["target"] = {
        {"path", "pointer"},
        {"extensions",
         {{"KHR_animation_pointer", {{"pointer", "/extensions/KHR_lights_punctual/lights/0/intensity"}}}}}};
    film.maker.json["extensionsUsed"] = {"KHR_animation_pointer", "KHR_lights_punctual"};
    const RenderedFrame frame = film.rendered(256);
    double sum = 0;
    for (int x = 10; x < 30; ++x) sum += column(frame, x);
    return sum;
  };
  const double steady = light_of({1, 1});
  EXPECT_GT(steady, 1);
  EXPECT_NEAR(light_of({0, 1}) / steady, 5.0 / 8, 0.003);
  EXPECT_NEAR(light_of({1, 0}) / steady, 3.0 / 8, 0.003);
}

/// A closed room whose walls emit 1 and reflect .5 holds the radiance 2 everywhere, and so does a leaf that turns in
/// it, whatever the camera does: it has an open lens that is focused on nothing, and it slides while the shutter is
/// open. 800 pixels of 1024 samples, whose spread is below 1: standard error .1 %. Meant to catch: samples of the lens
/// or of the moments that are weighted, rays that begin behind a wall.
TEST(Shutter, AFurnaceStaysUniform) {
  Film film;
  film.shutter_frames = 1;
  const int glow = film.maker.add_material(
      {{"emissiveFactor", {1, 1, 1}},
       {"doubleSided", true},
       {"pbrMetallicRoughness",
        {{"baseColorFactor", {0.5, 0.5, 0.5, 1}}, {"metallicFactor", 0}, {"roughnessFactor", 1}}},
       {"extensions", {{"KHR_materials_specular", {{"specularFactor", 0}}}}}});
  const int square = film.maker.add_square(glow);
  const double h = std::sqrt(0.5);
  const auto add_wall = [&](Json translation, Json rotation) {
    return film.maker.add_node(
        {{"mesh", square}, {"scale", {4, 4, 4}}, {"translation", translation}, {"rotation", rotation}});
  };
  for (const double z : {-2, 2}) add_wall({-2, -2, z}, {0, 0, 0, 1});
  for (const double y : {-2, 2}) add_wall({-2, y, 2}, {-h, 0, 0, h});
  for (const double x : {-2, 2}) add_wall({x, -2, 2}, {0, h, 0, h});
  const int leaf = film.maker.add_node({{"mesh", square}});
  film.camera = film.maker.add_camera({{"translation", {-1, 0, 1.5}}});
  film.maker.animate(film.camera, "translation", {0, 1 / 12.0f}, {-1, 0, 1.5f, 1, 0.3f, 1});
  film.maker.animate(leaf, "rotation", {0, 1 / 24.0f, 1 / 12.0f}, {0, 0, 0, 1, 0, float(h), 0, float(h), 0, 1, 0, 0});
  film.lens_radius_m = 0.1;
  const RenderedFrame frame = film.rendered(1024);
  double sum = 0;
  for (int x = 0; x < 40; ++x) {
    EXPECT_NEAR(column(frame, x), 2, 0.04) << x;
    sum += column(frame, x) / 40;
  }
  EXPECT_NEAR(sum, 2, 0.003 * 2);
}

/// Nothing that moves, or no time: no moments, so that a frame is the same bytes as without.
TEST(Shutter, IsNoneWhereNothingIsBlurred) {
  Film still;
  still.add_glowing_square();
  still.add_camera();
  still.at_frame_1([](const Shutter* shutter, const auto&, const auto&) { EXPECT_EQ(shutter, nullptr); });
  Film instant;
  const int square = instant.add_glowing_square();
  instant.add_camera();
  instant.maker.animate(square, "translation", {0, 1}, {0, 0, 0, 9, 0, 0});
  instant.shutter_frames = 0;
  instant.at_frame_1([](const Shutter* shutter, const auto&, const auto&) { EXPECT_EQ(shutter, nullptr); });
}

/// Light that belongs to the frame's time is found where the hit is then: a square that slides by .4 m a frame and
/// turns about z has its places and normals back. Meant to catch: places of the hit's own time.
TEST(Shutter, StoredLightSticksToWhatMoves) {
  Film film;
  film.shutter_frames = 2;
  const int square = film.add_glowing_square();
  film.add_camera();
  film.maker.animate(square, "translation", {0, 1 / 12.0f}, {0, 0, 0, 0.8f, 0, 0});
  film.at_frame_1([](const Shutter* shutter, const RenderScene& lit, const CameraView&) {
    ASSERT_NE(shutter, nullptr);
    const RenderScene &first = shutter->at(0).scene(), &last = shutter->at(0.999f).scene();
    for (const RenderScene* moment : {&first, &last}) {
      const SurfacePoint hit = moment->tracer.surface_point({0, 0, 0, 0.3f, 0.2f});
      const SurfacePoint then = lit.tracer.surface_point({0, 0, 0, 0.3f, 0.2f});
      EXPECT_GT(std::abs(hit.position.x - then.position.x), 0.3f);
      const StoredPlaces::Place place = moment->stored->of(hit, hit.normal_geometric, hit.normal);
      EXPECT_NEAR_VEC(place.surface.position, then.position, 1e-6f);
      EXPECT_NEAR_VEC(place.shading, then.normal, 1e-6f);
    }
  });
}

/// The square of ASlidingEdgeIsARamp faces the camera: the mean normal is (0, 0, share), and the square, seen from 3 m,
/// has the mean of 1 / Z share / 3. Of 64 independent rays in each of 12 pixels a share errs by sqrt(.25 / 768) = .018
/// at most; three times that. The channel N stays that of the pinhole. Meant to catch: means at the frame's time (.37
/// off beside the edge), rays that miss left out of the mean.
TEST(Shutter, MeansOfASlidingEdgeAreARamp) {
  Film film;
  const int square = film.add_glowing_square();
  film.add_camera();
  film.maker.animate(square, "translation", {0, 1 / 12.0f}, {0, 0, 0, 0.8f, 0, 0});
  film.at_frame_1([&](const Shutter* shutter, const RenderScene& lit, const CameraView& view) {
    Image image{40, 20, {}, {}, {}, {}};
    add_data_channels(lit, view, {"N", "albedo"}, {}, {}, image);
    add_feature_means(lit, view, shutter, {}, {"coverage"}, image);
    const auto mean = [&](const char* name, int x) {
      double sum = 0;
      for (int y = 4; y < 16; ++y) sum += double(image.find(name)->values[std::size_t(40 * y + x)]) / 12;
      return sum;
    };
    for (int x = 2; x < 38; ++x) {
      const double share = expected_column(8, 28, 4, x);
      EXPECT_NEAR(mean("coverage.mean.N.Z", x), share, 0.054) << x;
      EXPECT_NEAR(mean("coverage.mean.inverse_Z", x), mean("coverage.mean.N.Z", x) / 3, 1e-6) << x;
      EXPECT_EQ(mean("N.Z", x), x >= 8 && x < 28 ? 1 : 0) << x;
      const double measured = mean("coverage.mean.N.Z", x);
      EXPECT_LE(mean("coverage.error.N.Z", x), std::sqrt(measured * (1 - measured) / kMeanRays) + 1e-6) << x;
    }
    EXPECT_EQ(image.find("coverage.mean.N.X")->values[40 * 10 + 10], 0);
  });
}

/// A square that comes closer by 9.6 m a frame, seen by an orthographic camera, is one surface, as its points are
/// compared at the frame's time; where it slides, the ramps of 4 pixels at its edges see two. Meant to catch: places of
/// the samples' moments (all pixels of the square are edges), rays of the frame's time (no ramp).
TEST(Shutter, AMovingSurfaceHasSoftEdgesOnly) {
  for (const bool slides : {false, true}) {
    Film film;
    const int square = film.add_glowing_square({{"translation", {0.4, 0, -1}}});
    film.add_camera();
    const float x = slides ? 0.8f : 0.4f;
    film.maker.animate(square, "translation", {0, 1 / 12.0f}, {0.8f - x, 0, -1, x, 0, slides ? -1 : 1.4f});
    film.at_frame_1([&](const Shutter* shutter, const RenderScene& lit, const CameraView& view) {
      ASSERT_NE(shutter, nullptr);
      const std::vector<std::uint8_t> edges = soft_edges(lit, view, shutter);
      for (int column = 0; column < 40; ++column) {
        const double share = expected_column(8, 28, slides ? 4 : 0, column);
        if (share > 0 && share < 0.2) continue;  // eight rays may miss it
        if (share > 0.8 && share < 1) continue;
        EXPECT_EQ(edges[std::size_t(40 * 10 + column)], share > 0 && share < 1) << column << slides;
      }
    });
  }
}

}  // namespace
}  // namespace tempolux
