// What a pixel's samples see in mirrors: how far one's answer serves another.
#include "lib/render/pixel_light.h"

#include <gtest/gtest.h>

#include <cmath>

namespace tempolux {
namespace {

class Counting : public DiffuseLight {
 public:
  Irradiance at(const SurfacePoint&, Vec3, Vec3, bool, const Rgb*) const override {
    ++asked;
    return {};
  }
  mutable int asked = 0;
};

/// How often light is asked for if two samples see, in a mirror, places of one wall 10 m before the camera, `apart`
/// metres from each other. 1000 pixels share 10 m there.
int asked(float apart, float scene_size, Camera::Kind kind = Camera::Kind::perspective) {
  PlacedCamera camera;
  camera.camera.kind = kind;
  camera.camera.yfov_rad = 2 * std::atan(0.5f);
  camera.camera.ymag_m = 5;
  const CameraView view(camera, {}, 1000, 1000);
  const Counting light;
  PixelLight::Memory memory;
  SparseCaustics sparse;
  const PixelLight pixel(light, memory, sparse, view, scene_size);
  SurfacePoint place;
  place.surface = 0;
  for (const float x : {0.0f, apart}) {
    place.position = {x, 0, -10};
    pixel.at(place, {0, 0, 1}, {0, 0, 1}, false, nullptr);
  }
  return light.asked;
}

// 4 pixels are 40 mm; 1/256 of a scene of 5 m is 20 mm, of one of 1 km 4 m.
TEST(PixelLight, AnswersSeenInMirrorsHoldForPixelsAndNearby) {
  for (const Camera::Kind kind : {Camera::Kind::perspective, Camera::Kind::orthographic}) {
    EXPECT_EQ(asked(0.019f, 5, kind), 1);
    EXPECT_EQ(asked(0.021f, 5, kind), 2);
    EXPECT_EQ(asked(0.039f, 1000, kind), 1);
    EXPECT_EQ(asked(0.041f, 1000, kind), 2);
  }
}

}  // namespace
}  // namespace tempolux
