// Contributions of single photons to pixels, against the formula on paper.
#include "lib/audit/photon_splats.h"

#include <gtest/gtest.h>

#include "formats/octahedral.h"
#include "tests/support/frames.h"
#include "tests/support/scenes.h"

namespace tempolux {
namespace {

formats::Photon photon_at(std::array<float, 3> position, std::array<float, 3> normal) {
  return {.position = position,
          .flux = {1, 2, 3},
          .normal = formats::encode_normal(normal),
          .kind = formats::PathKind::indirect};
}

/// A floor of reflectance .6 in z = 0 fills the picture. A photon of flux 1 W adds rho / pi / (area of a pixel on the
/// floor): the formula's cosine and depth^3 / d cancel on a plane that is parallel to the picture.
struct Floor {
  test::HandMadeScene scene;
  Floor() { scene.add_quad({-4, -4, 0}, {4, -4, 0}, {4, 4, 0}, {-4, 4, 0}, test::matte(Rgb(0.6f))); }
  static CameraView perspective() {
    PlacedCamera camera;
    camera.camera.kind = Camera::Kind::perspective;
    camera.camera.yfov_rad = 2 * std::atan(0.5625);
    camera.scene_from_camera.translation = {0, 0, 1};
    return CameraView(camera, {}, 64, 36);
  }
};

TEST(PhotonSplats, ABrightnessThatDoesNotDependOnThePlace) {
  Floor floor;
  const Tracer tracer(floor.scene.frame());
  for (const CameraView& view : {test::from_above(), Floor::perspective()}) {
    const PhotonSplats splats(tracer, view);
    for (const float x : {0.01f, 0.5f, -0.9f}) {
      const std::optional<Splat> splat = splats.splat(photon_at({x, 0.2f, 0}, {0, 0, 1}), {}, {});
      ASSERT_TRUE(splat);
      const double expected = 0.6 / M_PI * 32 * 32;  // a pixel is 1/32 m wide
      EXPECT_NEAR(splat->radiance.r, expected, 1e-4 * expected) << x;
      EXPECT_NEAR(splat->radiance.b, 3 * expected, 3e-4 * expected) << x;
      EXPECT_EQ(splat->layer, Layer::indirect);
      EXPECT_EQ(splat->pixel, std::uint32_t((18 - 7) * 64 + int(32 + 32 * x))) << x;  // y = .2 m: 6.4 rows up
    }
  }
}

/// Not from outside the picture, not from the floor's other side, not from below a table.
TEST(PhotonSplats, OnlyOfPhotonsThatTheCameraSees) {
  Floor floor;
  floor.scene.add_quad({0.2f, -1, 0.1f}, {1, -1, 0.1f}, {1, 1, 0.1f}, {0.2f, 1, 0.1f}, test::matte(Rgb(0.5f)));
  const Tracer tracer(floor.scene.frame());
  const CameraView view = test::from_above();
  const PhotonSplats splats(tracer, view);
  EXPECT_FALSE(splats.splat(photon_at({2, 0, 0}, {0, 0, 1}), {}, {}));
  EXPECT_FALSE(splats.splat(photon_at({-0.5f, 0, 0}, {0, 0, -1}), {}, {}));
  EXPECT_FALSE(splats.splat(photon_at({0.5f, 0, 0}, {0, 0, 1}), {}, {}));
  EXPECT_TRUE(splats.splat(photon_at({-0.5f, 0, 0}, {0, 0, 1}), {}, {}));
}

/// A camera in the origin that looks along -z, focused at 2 m; its picture is 2 m wide at distance 1.
CameraView through_lens(double radius_m) {
  PlacedCamera placed;
  placed.camera.yfov_rad = 2 * std::atan(0.5625);
  placed.camera.lens_radius_m = radius_m;
  placed.camera.focus_m = 2;
  return CameraView(placed, {}, 64, 36);
}

/// Photons of a small patch behind the focus, through points of the lens: the same light as through a pinhole, over a
/// disc of pixels. Meant to catch: distances from the eye in place of the point of the lens.
TEST(PhotonSplats, ALensBlursThem) {
  test::HandMadeScene made;
  made.add_quad({-9, -9, -4}, {9, -9, -4}, {9, 9, -4}, {-9, 9, -4}, test::matte(Rgb(0.6f)));
  const Tracer tracer(made.frame());
  const CameraView sharp = through_lens(0), blurred = through_lens(0.5);
  const double diameter = blurred.blur(4);
  double sums[2] = {}, square = 0;
  for (int i = 0; i < 4000; ++i) {
    const formats::Photon photon{.position = {1 + 1e-4f * float(i % 64), 0.5f + 1e-4f * float(i / 64), -4},
                                 .flux = {1, 1, 1},
                                 .normal = formats::encode_normal(std::array{0.0f, 0.0f, 1.0f}),
                                 .kind = formats::PathKind::indirect};
    sums[0] += double(PhotonSplats(tracer, sharp).splat(photon, {}, {}).value().radiance.r);
    const Splat splat = PhotonSplats(tracer, blurred).splat(photon, {}, {}).value();
    sums[1] += double(splat.radiance.r);
    const double x = double(splat.pixel % 64) + 0.5 - sharp.project({1, 0.5f, -4}).value()[0];
    square += x * x / 4000;
  }
  // rho / pi |wo.n| depth^3 / d: at (1, .5, -4) the cosine is 4 / d, so the sum is that of the pinhole where lens
  // points lie evenly around the eye, up to 1e-3 of second order.
  EXPECT_NEAR(sums[1], sums[0], 0.003 * sums[0]);
  // 4000 points: the variance of a disc has a standard error of 1.4 %. A pixel adds 1/12.
  EXPECT_NEAR(square, diameter * diameter / 16 + 1.0 / 12, 0.05 * diameter * diameter / 16);
}

}  // namespace
}  // namespace tempolux
