// Light textures: uniform light stays uniform to the last element of a wall, walls do not mix, flux is kept, and sums
// do not depend on the order of photons.
#include "lib/light_texture/mesh_elements.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>
#include <random>

#include "formats/octahedral.h"
#include "lib/core/random.h"
#include "lib/light_texture/mesh_light.h"
#include "tests/support/scenes.h"

namespace tempolux {
namespace {

/// The elements that receive light through the filter, in the order of the file.
std::vector<formats::MeshElement> light_texture(const Tracer& tracer, const MeshSums& sums, const MeshFilter& filter) {
  std::vector<formats::MeshElement> elements = all_elements(tracer.frame(), sums.cuts());
  put_sums(sums, elements);
  std::vector<Rgbd> flux;
  for (const formats::MeshElement& e : elements)
    flux.push_back(Rgbd(double(e.sums[0]), double(e.sums[1]), double(e.sums[2])) * sums.unit());
  smooth_elements(tracer, flux, filter, {}, elements);
  leave_out_dark(elements);
  return elements;
}

/// A room of 2 m, and photons in it: one in the middle of each element of the inner sides, whose flux is
/// `irradiance(position)` times the element's area.
class LightTexture : public testing::Test {
 protected:
  static constexpr double kCell = 0.21;
  LightTexture() {
    room_.add_room({-1, -1, -1}, {1, 1, 1}, test::matte(Rgb(0.5f)));
    tracer_ = std::make_unique<Tracer>(room_.frame());
  }
  template <class Irradiance>
  std::vector<formats::Photon> photons(const Irradiance& irradiance) {
    std::vector<formats::Photon> photons;
    for (const formats::MeshElement& e : light_texture(*tracer_, full(), {MeshFilter::Kind::none, 1})) {
      const Vec3 p{e.position[0], e.position[1], e.position[2]};
      formats::Photon& photon = photons.emplace_back();
      photon.position = e.position;
      photon.normal = e.normal;
      photon.kind = formats::PathKind::indirect;
      for (float& flux : photon.flux) flux = irradiance(p) * e.area;
    }
    return photons;
  }
  /// One photon on each inner side of each triangle, so that all these elements are listed.
  MeshSums full() {
    MeshSums sums(*tracer_, cuts_, 1e-9);
    std::vector<formats::Photon> some;
    for (int i = 0; i < 3000; ++i) {
      const PathRandom random(7, std::uint64_t(i));
      const Vec2 a = random.get2(0, Purpose::test), b = random.get2(1, Purpose::test);
      const int axis = i % 3, other1 = (axis + 1) % 3, other2 = (axis + 2) % 3;
      Vec3 p, n;
      p[axis] = b.x < 0.5f ? -1.0f : 1.0f;
      n[axis] = -p[axis];
      p[other1] = 2 * a.x - 1;
      p[other2] = 2 * a.y - 1;
      formats::Photon& photon = some.emplace_back();
      photon.position = {p.x, p.y, p.z};
      photon.normal = formats::encode_normal({n.x, n.y, n.z});
      photon.flux = {1, 1, 1};
    }
    sums.add(some, {});
    EXPECT_EQ(sums.lost(), 0u);
    return sums;
  }
  std::vector<formats::MeshElement> texture(const std::vector<formats::Photon>& photons, const MeshFilter& filter) {
    MeshSums sums(*tracer_, cuts_, 1e-12);
    sums.add(photons, {});
    return light_texture(*tracer_, sums, filter);
  }

  test::HandMadeScene room_;
  std::unique_ptr<Tracer> tracer_;
  MeshCuts cuts_{kCell, {&room_.frame()}};
};

TEST_F(LightTexture, EvenLightStaysEvenAndWallsDoNotMix) {
  const auto irradiance = [](Vec3 p) { return p.y < -0.999f ? 2.0f : 1.0f; };  // the floor has twice as much
  const auto even = photons(irradiance);
  ASSERT_GT(even.size(), 1000u);
  for (const auto kind : {MeshFilter::Kind::none, MeshFilter::Kind::box, MeshFilter::Kind::gaussian})
    for (const formats::MeshElement& e : texture(even, {kind, 0.3}))
      EXPECT_NEAR(e.irradiance[1], irradiance({e.position[0], e.position[1], e.position[2]}), 1e-4) << int(kind);
}

/// The light of floor and ceiling rises from 1 to 4. One deviation from the step a Gaussian gives 1 + 3 x .16.
TEST_F(LightTexture, TheGaussianBlursAStepAndKeepsFlux) {
  const auto uneven = photons([](Vec3 p) { return p.x < 0 ? 1.0f : 4.0f; });
  double wanted = 0;
  for (const formats::Photon& p : uneven) wanted += double(p.flux[0]);
  double flux = 0, sum = 0, area = 0;
  for (const formats::MeshElement& e : texture(uneven, {MeshFilter::Kind::gaussian, 0.3})) {
    flux += double(e.irradiance[0] * e.area);
    if (std::abs(e.position[1]) < 0.999f || e.position[0] > -0.2f || e.position[0] < -0.4f) continue;
    sum += double(e.irradiance[0] * e.area);
    area += double(e.area);
  }
  EXPECT_NEAR(flux, wanted, 1e-4 * wanted);
  EXPECT_GT(sum / area, 1.35);
}

TEST_F(LightTexture, SumsHaveNoOrder) {
  const auto all = photons([](Vec3 p) { return 1 + p.x * p.y; });
  const std::span<const formats::Photon> some(all.data(), all.size() / 3),
      rest(all.data() + some.size(), all.size() - some.size());
  MeshSums at_once(*tracer_, cuts_, 1e-12), in_turn(*tracer_, cuts_, 1e-12);
  at_once.add(all, {});
  in_turn.add(rest, {});
  in_turn.add(some, {});
  ASSERT_EQ(at_once.cells().size(), in_turn.cells().size());
  for (const auto& [side, cells] : at_once.cells())
    for (std::size_t c = 0; c < cells.size(); ++c) {
      const MeshSums::Cell& other = in_turn.cells().at(side)[c];
      EXPECT_EQ(cells[c].photons, other.photons);
      EXPECT_EQ(cells[c].sums, other.sums);
      EXPECT_NEAR(cells[c].squares, other.squares, 1e-12 * other.squares);
    }
}

/// Light that is linear along the walls is read as it was stored. A corner inside a wall has the mean of elements
/// that lie symmetrically around it, and values between corners are linear, too. A corner at the rim of a wall has
/// the mean of one side's elements alone.
TEST_F(LightTexture, IsReadWhereItWasMade) {
  formats::MeshirradFile file;
  file.header.cell = kCell;
  file.elements = texture(photons([](Vec3 p) { return 2 + p.z; }), {MeshFilter::Kind::none, 1});
  const MeshLight light(file, room_.frame());
  int inside = 0;
  for (const formats::MeshElement& e : file.elements) {
    const auto n = formats::decode_normal(e.normal);
    const Vec3 normal{float(n[0]), float(n[1]), float(n[2])}, p{e.position[0], e.position[1], e.position[2]};
    Hit hit;
    ASSERT_TRUE(tracer_->intersect({p + normal * 0.01f, -normal, 0, 1}, hit));
    const float irradiance = light.irradiance(tracer_->surface_point(hit), normal).r;
    const bool rim = std::max({std::abs(p.x) * (1 - std::abs(normal.x)), std::abs(p.y) * (1 - std::abs(normal.y)),
                               std::abs(p.z) * (1 - std::abs(normal.z))}) > 0.7f;
    EXPECT_NEAR(irradiance, e.irradiance[0], rim ? 0.3 : 1e-3);
    inside += !rim;
    EXPECT_EQ(light.irradiance(tracer_->surface_point(hit), -normal).r, 0);
  }
  EXPECT_GT(inside, 100);
}

/// Photons of flux 1. Their number in an element has a Poisson distribution whose mean is `mean` of the element's
/// position.
MeshFlux scattered(const std::vector<formats::MeshElement>& elements, const std::function<double(float)>& mean) {
  std::mt19937_64 random(11);
  MeshFlux flux;
  for (const formats::MeshElement& e : elements) {
    const double n = double(std::poisson_distribution<int>(mean(e.position[0]) * double(e.area))(random));
    flux.mean.push_back(Rgbd(n));
    flux.squares.push_back(n);
  }
  return flux;
}

double rms(const std::vector<formats::MeshElement>& elements, const std::function<double(float)>& light) {
  double sum = 0;
  for (const formats::MeshElement& e : elements) {
    const double error = double(e.irradiance[0]) / light(e.position[0]) - 1;
    sum += error * error / double(elements.size());
  }
  return std::sqrt(sum);
}

/// Uniform light with 57 photons under the narrow Gaussian has a noise of 13 %. Under a Gaussian four times as wide a
/// quarter of this noise remains, c. The two bands between have the noises 2.7 c and 1.3 c. Their mean squares are
/// estimated from about 16 and 4 independent places, so the kept shares scatter: shares of .17 and .39 (rms,
/// integrals over chi squared) of the bands' noise remain, .46 c and .51 c. In all this is sqrt(1 + .46^2 + .51^2) c
/// = 1.21 c, below sqrt(2) c. Seen to fail (3.3 c) if all of both bands is kept.
TEST_F(LightTexture, ScalesRemoveNoise) {
  const auto even = [](float) { return 450.0; };
  std::vector<formats::MeshElement> elements = all_elements(room_.frame(), cuts_), coarse = elements;
  const MeshFlux flux = scattered(elements, even);
  smooth_by_scales(*tracer_, flux, 0.1, {}, elements);
  smooth_elements(*tracer_, flux.mean, {MeshFilter::Kind::gaussian, 0.4}, {}, coarse);
  EXPECT_LT(rms(elements, even), std::numbers::sqrt2 * rms(coarse, even));
  double kept = 0, wanted = 0;  // irradiance is rounded to float32, errors of 2^-25 that are independent
  for (std::size_t i = 0; i < elements.size(); ++i) {
    kept += double(elements[i].irradiance[1]) * double(elements[i].area);
    wanted += flux.mean[i].g;
  }
  EXPECT_NEAR(kept, wanted, 1e-8 * wanted);
}

/// A step of a factor of four with 10^4 times the photons: the noise is .1 %. All bands that the step changes are
/// signal, so the result is that of the narrow Gaussian alone.
TEST_F(LightTexture, ScalesKeepWhereLightVaries) {
  const auto step = [](float x) { return x < 0 ? 4.5e6 : 1.8e7; };
  std::vector<formats::MeshElement> elements = all_elements(room_.frame(), cuts_), narrow = elements;
  const MeshFlux flux = scattered(elements, step);
  smooth_by_scales(*tracer_, flux, 0.1, {}, elements);
  smooth_elements(*tracer_, flux.mean, {MeshFilter::Kind::gaussian, 0.1}, {}, narrow);
  for (std::size_t i = 0; i < elements.size(); ++i)
    EXPECT_NEAR(elements[i].irradiance[0] / narrow[i].irradiance[0], 1, 0.01);
}

/// A plate of .1 m that light meets from above alone. Its lower face has a back side in the plate, which faces up like
/// the upper face and lies within a width of it. No light arrives there. The kernel must leave it out: the irradiance
/// on top is 1, not 1 / (1 + exp(-.5 (.1/.3)^2)) = .51.
TEST(LightTextures, BacksOfSolidsTakeNoLight) {
  test::HandMadeScene plate;
  plate.add_box({-1, 0, -1}, {1, 0.1f, 1}, test::matte(Rgb(0.5f)));
  const Tracer tracer(plate.frame());
  std::vector<formats::MeshElement> elements = all_elements(plate.frame(), MeshCuts(0.2, {&plate.frame()}));
  const auto on_top = [](const formats::MeshElement& e) {
    return e.position[1] > 0.099f && formats::decode_normal(e.normal)[1] > 0.9;
  };
  std::vector<Rgbd> flux;
  for (const formats::MeshElement& e : elements) flux.push_back(Rgbd(on_top(e) ? double(e.area) : 0.0));
  smooth_elements(tracer, flux, {MeshFilter::Kind::gaussian, 0.3}, {}, elements);
  int count = 0;
  for (const formats::MeshElement& e : elements)
    if (on_top(e)) {
      EXPECT_NEAR(e.irradiance[1], 1, 1e-5);
      ++count;
    }
  EXPECT_GT(count, 0);
}

TEST_F(LightTexture, WidthsFollowFromThePhotons) {
  // Area 24 m^2, 1e6 photons, 256 of them in 4 pi s^2: s = sqrt(256 x 24 / (4 pi 1e6)).
  const MeshOptions options = with_widths({}, surface_area(room_.frame()), 1e6);
  EXPECT_NEAR(options.filter.width, std::sqrt(256 * 24 / (4 * 3.14159265 * 1e6)), 1e-6);
  EXPECT_EQ(options.cell, options.filter.width);
  EXPECT_EQ(with_widths({0.1, {MeshFilter::Kind::box, 0.4}}, 1, 5).cell, 0.1);
}

}  // namespace
}  // namespace tempolux
