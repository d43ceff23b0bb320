// How wide a preview's light textures are smoothed.
#include "lib/pilot/choose_preview.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "formats/octahedral.h"
#include "lib/pilot/pilot_photons.h"
#include "tests/support/scenes.h"

namespace tempolux {
namespace {

constexpr int kPhotons = 65536;
constexpr float kHalf = 2;  ///< half the room's edge, m

/// Photons that a point lamp at `height` above the middle of the floor of a cubic room throws on its walls.
std::vector<formats::Photon> photons_of(float height, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<float> uniform(-1, 1);
  std::vector<formats::Photon> photons;
  while (photons.size() < kPhotons) {
    const Vec3 d{uniform(random), uniform(random), uniform(random)};
    if (dot(d, d) > 1 || dot(d, d) < 0.01f) continue;
    const Vec3 lamp{0, height - kHalf, 0};
    int axis = 0;
    float way = 1e30f;
    for (int a = 0; a < 3; ++a)
      if (const float t = (std::copysign(kHalf, d[a]) - lamp[a]) / d[a]; t < way) way = t, axis = a;
    Vec3 at = lamp + d * way, normal;
    at[axis] = std::copysign(kHalf, d[axis]);
    normal[axis] = -std::copysign(1.0f, d[axis]);
    formats::Photon& photon = photons.emplace_back();
    photon.position = {at.x, at.y, at.z};
    photon.normal = formats::encode_normal({normal.x, normal.y, normal.z});
    photon.flux = {1, 1, 1};
  }
  return photons;
}

double kernel_at(float height) {
  test::HandMadeScene room;
  room.add_room({-kHalf, -kHalf, -kHalf}, {kHalf, kHalf, kHalf}, test::matte(Rgb(0.5f)));
  const Tracer tracer(room.frame());
  return best_kernel(tracer, photons_of(height, 1), photons_of(height, 2));
}

/// On the floor close to a lamp at height h, E = E0 (1 + q^2)^(-3/2) with q = r / h. A Gaussian of deviation s has
/// the bias s^2 / 2 times the Laplacian of E. The integral of the squared Laplacian over E is 5.257 pi E0 / h^2 = J
/// E0 / h^2 over the floor. The integral of the noise's variance over E is phi A / (4 pi s^2) over the room's area A,
/// where each of N photons has the flux phi = 4 pi h^2 E0 / N. The sum of both is least at s^6 = 2 A h^4 / (N J):
/// .149 m for h = .5 m, which is 190 photons. At s = .3 h the bias grows less than the law says, elements are as wide
/// as s, and other walls are nearly uniform; together these change the number of photons by less than a factor of
/// two. Seen to fail where each map is judged by itself (64) and without the cross term (642).
TEST(BestKernel, IsThatOfTheLeastErrorUnderALamp) {
  const double kernel = kernel_at(0.5f);
  EXPECT_GT(kernel, 190 / 2.0);
  EXPECT_LT(kernel, 190 * 2.0);
}

/// With the lamp in the middle, h = 2 m, all six walls contribute up to about q = 1: J = 6 x 13 and s = .29 m, 720
/// photons. At the walls' edges Gaussians are cut off and have a bias of first order, so the best Gaussian is
/// narrower.
TEST(BestKernel, IsWiderWhereLightIsEven) {
  const double kernel = kernel_at(2);
  EXPECT_GT(kernel, 720 / 2.0);
  EXPECT_LT(kernel, 720 * 2.0);
}

TEST(BestKernel, WithoutPhotons) {
  test::HandMadeScene room;
  room.add_room({-1, -1, -1}, {1, 1, 1}, test::matte(Rgb(0.5f)));
  const Tracer tracer(room.frame());
  EXPECT_EQ(best_kernel(tracer, {}, {}), 256);
}

/// With 16 times the photons the width is half as large, and four times the photons lie under the Gaussian.
TEST(ChoosePreview, ShrinksWithTheFourthRootOfThePhotons) {
  const PreviewPilot pilot{1, 24};
  const PreviewChoice few = choose_preview({&pilot, 1}, 200, 10'000, 33),
                      many = choose_preview({&pilot, 1}, 200, 160'000, 33);
  EXPECT_NEAR(many.width / few.width, 0.5, 1e-12);
  // As many photons as the pilot had: its kernel, s = sqrt(200 x 24 / (4 pi kPilotPaths)), on a grid of four steps from
  // each power of two to the next.
  const double width = std::sqrt(200 * 24 / (4 * std::numbers::pi * double(kPilotPaths)));
  const double chosen = choose_preview({&pilot, 1}, 200, kPilotPaths, 1).width;
  EXPECT_NEAR(std::log2(chosen / width), 0, 0.125);
  EXPECT_NEAR(std::log2(chosen) * 4, std::round(std::log2(chosen) * 4), 1e-9);
}

}  // namespace
}  // namespace tempolux
