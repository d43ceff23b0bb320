// The thin lens against formulas on paper.
#include <gtest/gtest.h>

#include <cmath>

#include "lib/render/feature_means.h"
#include "lib/render/data_channels.h"
#include "tests/support/frames.h"

namespace tempolux {
namespace {

/// A camera in the origin that looks along -z. Its picture of `width` x 9/16 `width` pixels is 2 m wide at distance 1.
CameraView view_of(Camera camera, int width = 64) {
  camera.yfov_rad = 2 * std::atan(0.5625);
  PlacedCamera placed;
  placed.camera = camera;
  return CameraView(placed, {}, width, width * 9 / 16);
}

CameraView lens_of(double radius_m, double focus_m, int width = 64) {
  Camera camera;
  camera.lens_radius_m = radius_m;
  camera.focus_m = focus_m;
  return view_of(camera, width);
}

/// Calls body(point of the lens) for a grid of points.
template <class Body>
void for_lens_points(int side, const Body& body) {
  for (int i = 0; i < side; ++i)
    for (int j = 0; j < side; ++j) body(Vec2{(float(i) + 0.5f) / float(side), (float(j) + 0.5f) / float(side)});
}

/// Through the points of a lens of radius r, focused at d, a point at depth z is seen in a disc of diameter
/// 2 r |z - d| / (z d) at distance 1, here times 32 pixels. The variance of a uniform disc along an axis is its squared
/// diameter / 16. Meant to catch: a lens whose points are squared towards the middle (variance), focus from the eye in
/// place of along the axis (the second point).
TEST(Lens, TheCircleOfConfusionHasItsDiameter) {
  const double r = 0.05, d = 2;
  const CameraView view = lens_of(r, d);
  for (const Vec3 point : {Vec3{0, 0, -4}, Vec3{-1.5f, 0.6f, -5}, Vec3{0.3f, -0.1f, -1}}) {
    const double z = -double(point.z), expected = 32 * 2 * r * std::abs(z - d) / (z * d);
    const auto middle = view.project(point).value();
    double farthest = 0, square = 0;
    int count = 0;
    for_lens_points(200, [&](Vec2 lens) {
      const auto at = view.project(point, lens).value();
      farthest = std::max(farthest, std::hypot(at[0] - middle[0], at[1] - middle[1]));
      square += (at[0] - middle[0]) * (at[0] - middle[0]);
      ++count;
    });
    EXPECT_NEAR(2 * farthest, expected, 0.01 * expected);  // the outermost points lie half a 200th inside
    EXPECT_NEAR(16 * square / count, expected * expected, 0.003 * expected * expected);
    EXPECT_NEAR(view.blur(z), expected, 1e-6 * expected);
  }
  const auto sharp = view.project({0.4f, 0.2f, -2}).value();
  for_lens_points(4, [&](Vec2 lens) {
    const auto at = view.project({0.4f, 0.2f, -2}, lens).value();
    EXPECT_NEAR(at[0], sharp[0], 1e-5);
    EXPECT_NEAR(at[1], sharp[1], 1e-5);
  });
}

/// ray() and project() are inverse to each other, at any distance of focus.
TEST(Lens, ARayShowsItsPointsAtItsRasterPosition) {
  for (const double focus : {1e-6, 0.3, 5.0, double(INFINITY)}) {
    const CameraView view = lens_of(1e-3, focus);
    for_lens_points(3, [&](Vec2 lens) {
      const CameraSample sample{{12.25f, 30.5f}, lens};
      const Ray ray = view.ray(sample);
      EXPECT_NEAR(length(ray.direction), 1, 1e-6);
      EXPECT_NEAR(length(ray.origin - view.lens_point(lens)), 0, 1e-9);
      if (focus < 1e-3) return;  // points beyond the focus lie far outside of the picture: float32 loses them
      const auto at = view.project(ray.origin + ray.direction * 7, lens).value();
      EXPECT_NEAR(at[0], 12.25, 1e-3);
      EXPECT_NEAR(at[1], 30.5, 1e-3);
    });
  }
  // Focused at infinity all rays of a raster position are parallel.
  const CameraView far = lens_of(0.1, INFINITY);
  EXPECT_NEAR(length(far.ray({{3, 4}, {0.9f, 0.2f}}).direction - far.pinhole({3, 4}).direction), 0, 1e-7);
}

/// A pinhole's rays are the same bits, whatever point of the lens a sample has.
TEST(Lens, NoneChangesNothing) {
  const CameraView view = view_of({});
  EXPECT_FALSE(view.has_lens());
  const Ray ray = view.ray({{10.3f, 5.7f}, {0.1f, 0.9f}}), pinhole = view.pinhole({10.3f, 5.7f});
  EXPECT_EQ(ray.origin.x, pinhole.origin.x);
  EXPECT_EQ(ray.direction.x, pinhole.direction.x);
  EXPECT_EQ(ray.direction.y, pinhole.direction.y);
  EXPECT_EQ(view.blur(3), 0);
}

/// Radius = focal length / (2 f-stop). 50 mm at f/2.5 is 10 mm. Without focal length: a sensor of 36 mm sees tan = 1 to
/// both sides at 18 mm. The picture's longer side counts.
TEST(Lens, FStopGivesTheRadius) {
  Camera camera;
  camera.f_stop = 2.5;
  camera.lens_mm = 50;
  EXPECT_DOUBLE_EQ(view_of(camera).lens_radius(), 0.01);
  camera.lens_mm = 0;
  camera.f_stop = 1.8;
  EXPECT_NEAR(view_of(camera).lens_radius(), 0.005, 1e-12);
  camera.sensor_width_mm = 72;
  EXPECT_NEAR(view_of(camera).lens_radius(), 0.01, 1e-12);
  camera.kind = Camera::Kind::orthographic;
  EXPECT_EQ(view_of(camera).lens_radius(), 0);
}

/// A lamp of 6 x 6 pixels behind the focus: blurred over a disc of 8 pixels it has the same light in the whole picture,
/// as from each point of the lens it covers the same area of the picture. 36 pixels' samples decide, of which most are
/// not at the border: Sobol points leave about .1 %. Meant to catch: rays that start on the lens and keep the pinhole's
/// direction (a lamp that is not 6 pixels wide).
TEST(Lens, BlurKeepsTheLight) {
  test::HandMadeScene made;
  const float z = -4, half = 3.0f / 16 * 4;  // 16 pixels for 1 m at distance 1
  made.add_quad({-half, -half, z}, {half, -half, z}, {half, half, z}, {-half, half, z},
                test::matte(Rgb(0.0f), Rgb(1.0f)));
  const SceneFrame& frame = made.frame();
  const test::Lit lit(frame);
  const auto light = [&](const CameraView& view, double& spread) {
    FrameOptions options;
    options.samples = 2048;
    const RenderedFrame rendered = render_frame(lit.scene(), view, options);
    double sum = 0, square = 0;
    for (std::size_t p = 0; p < rendered.mean.pixels.size(); ++p) {
      const double value = radiance_of(rendered.mean.pixels[p]), x = double(p % 32) + 0.5 - 16;
      sum += value;
      square += value * x * x;
    }
    spread = square / sum;
    return sum;
  };
  double sharp = 0, blurred = 0;
  // 16 x 2 r |4 - 2| / 8 = 8 pixels: r = 1 m.
  EXPECT_NEAR(light(view_of({}, 32), sharp), 36, 0.003 * 36);
  EXPECT_NEAR(light(lens_of(1, 2, 32), blurred), 36, 0.003 * 36);
  // Sums over pixels: blurred edges add 1/12, the sharp lamp's edges, at borders of pixels, take 1/12 away.
  EXPECT_NEAR(blurred - sharp, 8.0 * 8 / 16 + 1.0 / 6, 0.01 * 4);
}

/// A wall of reflectance .2 on the left of x = 0 and one of .8 on its right, 4 m in front of the camera. The right
/// wall's far end, at x = 9, lies at z = `end`.
struct TwoWalls {
  explicit TwoWalls(float end) : frame(of(made, end)), lit(frame) {}

  test::HandMadeScene made;
  const SceneFrame& frame;
  test::Lit lit;

 private:
  static const SceneFrame& of(test::HandMadeScene& made, float end) {
    made.add_quad({-9, -9, -4}, {0, -9, -4}, {0, 9, -4}, {-9, 9, -4}, test::matte(Rgb(0.2f)));
    made.add_quad({0, -9, -4}, {9, -9, end}, {9, 9, end}, {0, 9, -4}, test::matte(Rgb(0.8f)));
    return made.frame();
  }
};

/// Behind the focus, the border between a dark and a bright wall runs down the middle of the picture. Through a lens
/// whose discs are 8 pixels wide, a pixel there has half of each albedo, and at the disc's quarter (2 pixels off) the
/// share of a disc beyond a chord at half its radius, 1/3 - sqrt(3) / (4 pi) = .1955, has the other one. A pinhole
/// keeps both.
TEST(Lens, AlbedoIsAMeanOverTheLens) {
  TwoWalls walls(-4);
  const CameraView view = lens_of(1, 2, 32);
  Image image{32, 18, {}, {}, {}, {}};
  add_data_channels(walls.lit.scene(), view, {"albedo"}, {}, {}, image);
  const auto row_mean = [&](int x) {  // of both columns beside the place x
    double sum = 0;
    for (int y = 0; y < 18; ++y)
      for (const int column : {x - 1, x})
        sum += double(image.find("albedo.G")->values[std::size_t(32 * y + column)]) / 36;
    return sum;
  };
  EXPECT_NEAR(row_mean(14), 0.2, 1e-6);
  add_feature_means(walls.lit.scene(), view, nullptr, {}, {}, image);
  EXPECT_NEAR(row_mean(16), 0.5, 0.01);
  // Pixels on both sides of the place average over 2 pixels: the circle's curvature there adds less than .003.
  EXPECT_NEAR(row_mean(14), 0.2 + 0.6 * (1 / 3.0 - std::sqrt(3.0) / (4 * M_PI)), 0.01);
  EXPECT_NEAR(row_mean(6), 0.2, 1e-6);
}

/// A pixel that sees the dark wall with the share 1 - p and the bright one with p has the mean albedo .2 + .6 p. On
/// paper the standard error of this mean is .6 sqrt(p (1 - p) / 64) for independent rays. All rays see 1 / Z = 1 / 4.
/// The channel N stays that of the pinhole. Meant to catch: the variance in place of its root, the error of one ray,
/// means that replace the pinhole's normal.
TEST(Lens, TheErrorOfAMeanIsThatOfItsShares) {
  TwoWalls walls(-3);
  const CameraView view = lens_of(1, 2, 32);
  Image image{32, 18, {}, {}, {}, {}};
  add_data_channels(walls.lit.scene(), view, {"albedo", "N"}, {}, {}, image);
  add_feature_means(walls.lit.scene(), view, nullptr, {}, {"coverage"}, image);
  const auto at = [&](const char* name, int x, int y) {
    return double(image.find(name)->values[std::size_t(32 * y + x)]);
  };
  const double tilted = 1 / std::sqrt(82.0);  // of the bright wall's normal (-1, 0, 9): its part along -x
  int soft = 0;
  for (int y = 0; y < 18; ++y)
    for (int x = 0; x < 32; ++x) {
      const double p = std::round((at("albedo.G", x, y) - 0.2) / 0.6 * kMeanRays) / kMeanRays;
      soft += p > 0.01 && p < 0.99;
      EXPECT_NEAR(at("coverage.error.albedo.G", x, y), 0.6 * std::sqrt(p * (1 - p) / kMeanRays), 1e-5);
      EXPECT_NEAR(at("coverage.mean.N.X", x, y), -tilted * p, 1e-5);
      EXPECT_NEAR(at("N.X", x, y), x < 16 ? 0 : -tilted, 1e-6);
    }
  EXPECT_GT(soft, 18 * 7);  // discs of 8 pixels
  EXPECT_NEAR(at("coverage.mean.inverse_Z", 2, 9), 0.25, 1e-6);
  EXPECT_NEAR(at("coverage.error.inverse_Z", 2, 9), 0, 1e-7);
}

/// In a sharp picture of 33 columns the walls meet in the middle of column 16. Pixels at the edge take the means of 64
/// rays: half of column 16 shows each wall, and 64 stratified rays err less than independent ones, .6 x .0625. The
/// other pixels take their centre's ray, without an error. albedo stays that of the pinhole. Meant to catch: means of
/// all pixels by one ray, edges by one ray.
TEST(Lens, SharpPicturesTakeMeansAtEdges) {
  TwoWalls walls(-4);
  const CameraView view = lens_of(0, 2, 33);
  Image image{view.width(), view.height(), {}, {}, {}, {}};
  add_data_channels(walls.lit.scene(), view, {"albedo"}, {}, {}, image);
  std::vector<std::uint8_t> edges(image.pixel_count());
  for (int y = 0; y < view.height(); ++y) edges[std::size_t(33 * y + 16)] = 1;
  const std::vector<float> pinhole = image.find("albedo.G")->values;
  add_feature_means(walls.lit.scene(), view, nullptr, edges, {"coverage"}, image);
  const auto at = [&](const char* name, int x) { return double(image.find(name)->values[std::size_t(33 * 5 + x)]); };
  EXPECT_NEAR(at("coverage.mean.albedo.G", 16), 0.5, 0.6 * 0.0625);
  EXPECT_NEAR(at("coverage.error.albedo.G", 16), 0.6 * 0.0625, 1e-3);
  for (const auto& [x, albedo] : {std::pair{15, 0.2}, {17, 0.8}}) {
    EXPECT_NEAR(at("coverage.mean.albedo.G", x), albedo, 1e-6);
    EXPECT_EQ(at("coverage.error.albedo.G", x), 0);
    EXPECT_NEAR(at("coverage.mean.inverse_Z", x), 0.25, 1e-6);
  }
  EXPECT_EQ(image.find("albedo.G")->values, pinhole);
}

}  // namespace
}  // namespace tempolux
