// Parts of a pixel's samples: each camera ray has its share, and no number of samples changes the mean.
#include <gtest/gtest.h>

#include <cmath>

#include "lib/render/pixel_samples.h"
#include "tests/support/frames.h"

namespace tempolux {
namespace {

using test::Cornell;
using test::HandMadeScene;

/// Of 7 camera rays that share 3, 7, 10 or 28 samples, each has the floor or the ceiling of its share, all together
/// have that number, and the indices of samples have no gap. Over 4000 pixels each ray has the same share, within 4
/// sigma of a number that has two values.
TEST(PixelParts, AreDealtOutEvenly) {
  for (const int count : {3, 7, 10, 28}) {
    constexpr int kPixels = 4000;
    double of_ray[7] = {};
    for (std::uint64_t pixel = 0; pixel < kPixels; ++pixel) {
      const Dealt dealt(5, pixel, {4, 6, 2}, {7, count, 28 - count});
      std::uint32_t next_lit = 6, next_onward = 2;
      for (int i = 0; i < 7; ++i) {
        const PathEffort effort = dealt(i);
        EXPECT_EQ(effort.lit_first, next_lit);
        EXPECT_EQ(effort.onward_first, next_onward);
        next_lit += effort.lit;
        next_onward += effort.onward;
        EXPECT_GE(int(effort.lit), count / 7);
        EXPECT_LE(int(effort.lit), (count + 6) / 7);
        of_ray[i] += effort.lit;
      }
      EXPECT_EQ(next_lit, 6u + std::uint32_t(count));
      EXPECT_EQ(next_onward, 2u + std::uint32_t(28 - count));
    }
    for (const double n : of_ray) EXPECT_NEAR(n / kPixels, count / 7.0, 4 * 0.5 / std::sqrt(double(kPixels))) << count;
  }
}

/// Mean of a layer over a picture of 64 x 36 with given numbers of each part, each divided by its own number; and the
/// mean's error from 16 seeds.
struct Told {
  double mean = 0, error = 0;
};
Told tell(const RenderScene& scene, const CameraView& view, Layer layer, const PartCounts& count) {
  constexpr int kSeeds = 16;
  double sum = 0, square = 0;
  for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
    double all = 0;
    RayCounts rays;
    for (int y = 0; y < view.height(); ++y)
      for (int x = 0; x < view.width(); ++x) {
        const PixelPass pass{std::size_t(y * view.width() + x), x, y, {}, count};
        const PixelSum of = sample_pixel({scene, view, nullptr, seed}, pass, nullptr, rays);
        all += of.own[layer].g / count.own + of.lit[layer].g / count.lit + of.onward[layer].g / count.onward;
      }
    sum += all;
    square += all * all;
  }
  const double mean = sum / kSeeds;
  return {mean, std::sqrt(std::max(0.0, square / kSeeds - mean * mean) / (kSeeds - 1))};
}

/// A wide lamp close to walls, whose light both parts find: if a part's number were missing in its weight, or the two
/// weights were not those of one sample each, direct light would be off by 10 % and more. Indirect light is in the
/// onward part alone. 4 sigma.
TEST(PixelParts, NoNumberChangesTheMean) {
  const Cornell c;
  for (const Layer layer : {Layer::direct, Layer::indirect}) {
    const Told one = tell(c.render_scene(), c.view, layer, {6, 6, 6});
    for (const PartCounts& count : {PartCounts{4, 12, 2}, PartCounts{4, 2, 12}}) {
      const Told other = tell(c.render_scene(), c.view, layer, count);
      EXPECT_NEAR(other.mean, one.mean, 4 * std::hypot(one.error, other.error)) << int(layer);
      EXPECT_LT(4 * std::hypot(one.error, other.error), 0.02 * one.mean) << int(layer);
    }
  }
}

}  // namespace
}  // namespace tempolux
