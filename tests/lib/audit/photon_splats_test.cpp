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

}  // namespace
}  // namespace tempolux
