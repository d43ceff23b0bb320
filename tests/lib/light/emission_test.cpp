// Photons leave lights with the flux, the places and the directions of their emission; the table is frozen.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>

#include "formats/error.h"
#include "lib/core/halton.h"
#include "tests/lib/light/light_scene.h"
#include "tests/support/scene_at_frame.h"

namespace tempolux {
namespace {

constexpr double kPiD = std::numbers::pi;
constexpr int kCount = 1 << 16;

template <class Take>
void emit_all(const Lights& lights, int count, Take take) {
  const PhotonHalton halton(1);
  constexpr int kAtOnce = 37;
  std::array<std::array<double, 4>, kAtOnce> u;
  std::array<PhotonEmission, kAtOnce> photons;
  for (int first = 0; first < count; first += kAtOnce) {
    const auto n = std::size_t(std::min(kAtOnce, count - first));
    for (std::size_t i = 0; i < n; ++i) u[i] = halton.point(std::uint64_t(first) + i);
    lights.emit({u.data(), n}, {photons.data(), n});
    for (std::size_t i = 0; i < n; ++i) take(photons[i]);
  }
}

/// Seen to fail: one side of a two-sided lamp left out.
TEST(TotalFlux, IsPiLATimesSides) {
  for (const bool two_sided : {false, true}) {
    LightScene scene;
    scene.add(square_facing_down({0, 0, 1}, 1.5f), Rgb(1, 2, 4), two_sided);
    const Rgbd flux = scene.lights().total_flux();
    const double sides = two_sided ? 2 : 1;
    EXPECT_NEAR(flux.r, sides * kPiD * 9, 1e-5);
    EXPECT_NEAR(flux.b, sides * kPiD * 36, 1e-4);
  }
}

// Point 4 pi I; a spot without penumbra 2 pi (1 - cos) I, with: s^2 integrates to a third over the penumbra;
// directional E pi R^2 with R half the diagonal of the bounds.
TEST(TotalFlux, OfPunctualLightsIsTheirSolidAngleOrDisc) {
  const auto flux = [](PunctualLight::Kind kind, float inner, float outer) {
    LightScene scene(2);
    scene.add(kind, Rgb(3.0f), {}, {0, 0, -1}, inner, outer);
    return scene.lights().total_flux().g;
  };
  EXPECT_NEAR(flux(PunctualLight::Kind::point, 0, 1), 12 * kPiD, 1e-5);
  EXPECT_NEAR(flux(PunctualLight::Kind::spot, 0.5f, 0.5f), 6 * kPiD * (1 - std::cos(0.5)), 1e-6);
  EXPECT_NEAR(flux(PunctualLight::Kind::spot, 0, 0.5f), 2 * kPiD * (1 - std::cos(0.5)), 1e-6);
  EXPECT_NEAR(flux(PunctualLight::Kind::spot, 0.5f, 1.0f),
              6 * kPiD * (1 - std::cos(0.5) + (std::cos(0.5) - std::cos(1.0)) / 3), 1e-6);
  EXPECT_NEAR(flux(PunctualLight::Kind::directional, 0, 1), 3 * kPiD * 12, 3 * kPiD * 12 * 3e-5);
}

LightScene all_kinds() {
  LightScene scene(4);
  scene.add(square_facing_down({0, 0, 1}, 0.5f), Rgb(5, 1, 0));
  scene.add(square_facing_down({2, 0, 1}, 0.3f), Rgb(0, 0, 20), true);
  scene.add(PunctualLight::Kind::point, Rgb(1, 2, 3), {1, 1, 1}, {0, 0, -1});
  scene.add(PunctualLight::Kind::spot, Rgb(9, 8, 7), {-1, 1, 1}, {0.6f, 0, -0.8f}, 0.3f, 0.6f);
  scene.add(PunctualLight::Kind::directional, Rgb(0.05f), {}, {0, 0.6f, -0.8f});
  return scene;
}

// The slot is chosen by a low-discrepancy coordinate: error of order slots / N.
TEST(Emission, MeanFluxIsTheTotal) {
  const LightScene scene = all_kinds();
  const Lights lights = scene.lights();
  Rgbd sum;
  emit_all(lights, kCount, [&](const PhotonEmission& e) { sum += Rgbd(e.flux); });
  const Rgbd total = lights.total_flux();
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(sum[c] / kCount, total[c], 1e-3 * total[c]);
}

// The probability of a lamp is proportional to the luminance of its flux, but at least to 5 % of its largest channel.
// A blue lamp has 7 % of the luminance of a white one. Probabilities sum to one.
TEST(Emission, ProbabilitiesFollowTheLuminanceOfTheFlux) {
  LightScene scene;
  scene.add(PunctualLight::Kind::point, Rgb(1.0f), {}, {0, 0, -1});
  scene.add(PunctualLight::Kind::point, Rgb(0, 0, 1), {}, {0, 0, -1});
  const EmissionTable table = scene.table();
  EXPECT_NEAR(table.probability[1] / table.probability[0], 0.0722, 1e-6);
  EXPECT_NEAR(table.probability[0] + table.probability[1], 1, 1e-15);
}

// Slots drawn one by one or many at once, for a lamp with two sides, a lamp with one side and a point light. Dark
// lights are never drawn.
TEST(Emission, SlotsAreChosenByTheirPartOfTheUnitInterval) {
  LightScene scene;
  scene.add(square_facing_down({0, 0, 1}, 1), Rgb(0.0f));
  scene.add(square_facing_down({0, 0, 2}, 1), Rgb(1.0f), true);
  scene.add(square_facing_down({0, 0, 3}, 1), Rgb(3.0f));
  scene.add(PunctualLight::Kind::point, Rgb(2.0f), {0, 0, 4}, {0, 0, -1});
  scene.add(PunctualLight::Kind::point, Rgb(0.0f), {0, 0, 5}, {0, 0, -1});
  const Lights lights = scene.lights();
  ASSERT_EQ(lights.slots().size(), 6u);  // triangles that emit nothing have no slot
  std::vector<std::array<double, 4>> u;
  std::vector<std::size_t> expected;
  double below = 0;
  for (std::size_t slot = 0; slot < lights.slots().size(); ++slot) {
    const double part = lights.slots()[slot].probability;
    for (const double share : {0.0, 0.5, 0.999}) {
      if (!(part > 0)) continue;
      u.push_back({below + share * part, 0.3, 0.25 + share / 2, 0.7});
      expected.push_back(slot);
    }
    below += part;
  }
  std::vector<PhotonEmission> photons(u.size());
  lights.emit(u, photons);
  for (std::size_t i = 0; i < u.size(); ++i) {
    const PhotonEmission alone = lights.emit(u[i]);
    EXPECT_EQ(photons[i].slot, expected[i]) << i;
    EXPECT_EQ(photons[i].origin, alone.origin);
    EXPECT_EQ(photons[i].travel, alone.travel);
    EXPECT_EQ(photons[i].flux, alone.flux);
    EXPECT_NEAR(photons[i].flux.r, lights.total_flux().r, 1e-4 * lights.total_flux().r);
    const bool back = lights.slots()[expected[i]].kind == EmissionSlot::Kind::triangle && photons[i].normal.z > 0;
    EXPECT_EQ(back, expected[i] < 2 && u[i][2] >= 0.5);
  }
}

// Photons of the square start in the mean at its centroid and have the mean cosine 2/3 of a Lambert emitter. If the
// square has two sides, each emits half of them. Seen to fail: the square mapped to the triangle by (u, v (1 - u)).
TEST(Emission, AreaLightsEmitUniformlyByTheCosine) {
  for (const bool two_sided : {false, true}) {
    LightScene scene;
    scene.add(square_facing_down({1, 2, 3}, 0.5f), Rgb(1.0f), two_sided);
    Vec3d place, travel, from_front;
    double cosine = 0, square = 0, down = 0;
    emit_all(scene.lights(), kCount, [&](const PhotonEmission& e) {
      place += Vec3d(e.origin) / double(kCount);
      travel += Vec3d(e.travel) / double(kCount);
      cosine += double(dot(e.travel, e.normal)) / kCount;
      square += double(e.travel.x * e.travel.x) / kCount;
      down += e.normal.z < 0;
      if (e.normal.z < 0) from_front += Vec3d(e.travel) / double(kCount);
      ASSERT_GT(dot(e.travel, e.normal), 0);
      ASSERT_FLOAT_EQ(e.origin.z, 3);
      ASSERT_GT(e.origin_offset, 0);
    });
    EXPECT_NEAR(place.x, 1, 1e-3);
    EXPECT_NEAR(place.y, 2, 1e-3);
    EXPECT_NEAR(cosine, 2.0 / 3, 1e-3);
    EXPECT_NEAR(square, 0.25, 1e-3);  // sin^2 cos^2(phi): half of the mean sin^2, 1/2
    EXPECT_NEAR(down / kCount, two_sided ? 0.5 : 1, 1e-3);
    EXPECT_NEAR(travel.z, two_sided ? 0 : -2.0 / 3, 2e-3);
    EXPECT_NEAR(from_front.x, 0, 1e-3);  // either side shines all around
    EXPECT_NEAR(from_front.y, 0, 1e-3);
  }
}

// Let a = 1 - cos i and w = cos i - cos o. The share of photons within the inner cone is a / (a + w / 3). The share
// within the angle at which s = 1/2 (a quarter of the intensity) is (a + w (1 - 1/8) / 3) / (a + w / 3).
TEST(Emission, SpotsEmitByTheirFalloff) {
  LightScene scene;
  const Vec3 axis = normalize(Vec3{1, -2, 0.5f});
  scene.add(PunctualLight::Kind::spot, Rgb(1.0f), {0, 1, 0}, axis, 0.4f, 0.9f);
  int inner = 0, half = 0;
  emit_all(scene.lights(), kCount, [&](const PhotonEmission& e) {
    const float c = dot(e.travel, axis);
    ASSERT_GE(c, std::cos(0.9f) - 1e-5f);
    ASSERT_EQ(e.origin, (Vec3{0, 1, 0}));
    ASSERT_EQ(e.normal, Vec3{});
    inner += c > std::cos(0.4f);
    half += c > (std::cos(0.4f) + std::cos(0.9f)) / 2;
  });
  const double a = 1 - std::cos(0.4), w = std::cos(0.4) - std::cos(0.9);
  EXPECT_NEAR(double(inner) / kCount, a / (a + w / 3), 2e-3);
  EXPECT_NEAR(double(half) / kCount, (a + w * 7 / 24) / (a + w / 3), 2e-3);
}

TEST(Emission, PointsEmitEverywhereAlike) {
  LightScene scene;
  scene.add(PunctualLight::Kind::point, Rgb(1.0f), {0, 1, 0}, {0, 0, -1});
  Vec3d mean, square;
  emit_all(scene.lights(), kCount, [&](const PhotonEmission& e) {
    const Vec3d t(e.travel);
    mean += t / double(kCount);
    square += Vec3d{t.x * t.x, t.y * t.y, t.z * t.z} / double(kCount);
  });
  for (int i = 0; i < 3; ++i) {
    EXPECT_NEAR(mean[i], 0, 1e-3);
    EXPECT_NEAR(square[i], 1.0 / 3, 1e-3);
  }
}

// Every origin lies outside the scene's box, before it, on a disc whose mean square radius is R^2 / 2.
TEST(Emission, DirectionalLightsStartOnADiscOutsideTheScene) {
  LightScene scene(4);
  const Vec3 travel = normalize(Vec3{1, 2, -2});
  scene.add(PunctualLight::Kind::directional, Rgb(1.0f), {}, travel);
  double square = 0;
  emit_all(scene.lights(), kCount, [&](const PhotonEmission& e) {
    ASSERT_EQ(e.travel, travel);
    ASSERT_NEAR(dot(e.origin, travel), -std::sqrt(48.0f), 1e-2);
    const Vec3 across = e.origin - travel * dot(e.origin, travel);
    square += double(length2(across)) / kCount;
  });
  EXPECT_NEAR(square, 24, 0.05);
}

// In three frames one lamp dims to nothing and another shrinks to nothing. Slots and probabilities stay, and weights
// change.
TEST(Emission, TableIsFrozenOverTheSegment) {
  std::vector<LightScene> scenes(3);
  const float emission[] = {1, 4, 0}, half[] = {0.5f, 0, 1};
  for (int f = 0; f < 3; ++f) {
    scenes[std::size_t(f)].add(square_facing_down({0, 0, 1}, 1), Rgb(emission[f]));
    scenes[std::size_t(f)].add(square_facing_down({3, 0, 1}, half[f]), Rgb(1.0f));
  }
  std::vector<SceneFrame> frames;
  for (const LightScene& s : scenes) frames.push_back(s.frame);
  const EmissionTable table = build_emission_table(frames);
  // Maxima: 4 x 4 m^2 and 1 x 4 m^2, two triangles each.
  ASSERT_EQ(table.probability.size(), 4u);
  EXPECT_NEAR(table.probability[0], 0.4, 1e-9);
  EXPECT_NEAR(table.probability[3], 0.1, 1e-9);
  for (int f = 0; f < 3; ++f) {
    const Lights lights(frames[std::size_t(f)], table);
    ASSERT_EQ(lights.count(), 4u);
    std::map<std::uint32_t, int> seen;
    Rgbd sum;
    emit_all(lights, 1 << 12, [&](const PhotonEmission& e) {
      ++seen[e.slot];
      sum += Rgbd(e.flux) / double(1 << 12);
      ASSERT_TRUE(is_finite(e.travel) && is_finite(e.origin));
    });
    EXPECT_NEAR(seen[0], 0.4 * 4096, 4);
    EXPECT_NEAR(sum.g, lights.total_flux().g, 2e-3 * lights.total_flux().g);
    EXPECT_NEAR(lights.total_flux().g, kPiD * 4 * (emission[f] + half[f] * half[f]), 1e-4);
  }
}

// Two equal emitters, one growing from scale 1 at frame 0 to 3 at frame 24: over the frames 0..23 of the
// segment its largest area is (1 + 2 23/24)^2 times the other's, whatever frame is asked for.
TEST(Emission, TableKnowsTheLargestSizeOfAnAnimatedEmitter) {
  Scene scene;
  Primitive square;
  square.positions = square_facing_down({0, 0, 0}, 1);
  square.triangles = {{0, 1, 2}, {0, 2, 3}};
  scene.materials.emplace_back();
  scene.materials[0].emission = Rgb(1.0f);
  scene.meshes.push_back({"lamp", {square}});
  scene.nodes.resize(2);
  for (std::uint32_t i = 0; i < 2; ++i) {
    scene.nodes[i].mesh = 0;
    scene.nodes[i].object = i;
    scene.nodes[i].translation = {10.0 * i, 0, 0};
    scene.object_names.push_back("lamp");
  }
  AnimationTrack grow;
  grow.target = 0;
  grow.path = AnimationTrack::Path::scale;
  grow.times_s = {0, 1};
  grow.values = {1, 1, 1, 3, 3, 3};
  scene.animations.push_back({"grow", {grow}});
  scene.duration_s = 1;
  const TimeOptions options;
  const Segment segment = segment_of(scene, 5, options);
  ASSERT_EQ(segment.last, 24);
  const EmissionTable table = build_emission_table(scene, segment, options);
  ASSERT_EQ(table.probability.size(), 4u);
  const double largest = std::pow(3, 2);
  const double moving = table.probability[2] + table.probability[3];  // static surfaces come first
  EXPECT_NEAR(moving, largest / (1 + largest), 1e-6);
  const SceneFrame frame = scene_at_frame(scene, segment, 0, options);
  EXPECT_NEAR(Lights(frame, table).total_flux().r, 2 * 4 * kPiD, 1e-5);
}

TEST(Emission, FluxBeyondFloatIsRefusedNotDropped) {
  LightScene scene(1e6f);
  scene.add(square_facing_down({0, 0, 1}, 1e6f), Rgb(1e30f));  // pi 1e30 4e12 = 1.3e43 W
  const Lights lights = scene.lights();
  EXPECT_NEAR(lights.total_flux().r, kPiD * 4e42, 1e37);
  const std::array<double, 4> u = {0.5, 0.5, 0.5, 0.5};
  EXPECT_THROW(lights.emit(u), InputError);
}

TEST(Emission, NoLightIsEmptyAndDark) {
  LightScene scene;
  scene.add(square_facing_down({0, 0, 1}, 1), Rgb(0.0f));
  const Lights lights = scene.lights();
  EXPECT_TRUE(lights.empty());
  EXPECT_EQ(lights.total_flux(), Rgbd());
  LightSample s;
  EXPECT_FALSE(lights.sample({}, {}, 0.5f, {}, s));
  EXPECT_EQ(lights.pdf_solid_angle({}, {}, 0, 0, {0, 0, 1}), 0);
}

TEST(Lights, EmitFromTheFrontAndFromBothSidesIfTwoSided) {
  LightScene scene;
  const std::uint32_t one = scene.add(square_facing_down({0, 0, 1}, 1), Rgb(2.0f));
  const std::uint32_t two = scene.add(square_facing_down({0, 0, 1}, 1), Rgb(3.0f), true);
  const Lights lights = scene.lights();
  const Vec3 front{0, 0, -1};
  const auto hit = [&](std::uint32_t surface) {
    SurfacePoint point;
    point.surface = surface;
    point.material = scene.frame.surfaces[surface].material;
    point.normal_geometric = front;
    return point;
  };
  EXPECT_EQ(lights.emitted(hit(one), {0, 0, -1}, 0), Rgb(2.0f));
  EXPECT_EQ(lights.emitted(hit(one), {0, 0, 1}, 0), Rgb(0.0f));
  EXPECT_EQ(lights.emitted(hit(two), {0, 0, 1}, 0), Rgb(3.0f));
}

/// A lamp of 4 pi W beside a sun of 2e5 W and a lamp 1000 times as strong: without the sun, half of the photons by flux
/// and half by lamp, so the weak lamp has 1/2 (1 / 1001 + 1 / 2) of them, and its flux is the same.
TEST(Emission, PlacedAlikeGivesEveryLampPhotons) {
  LightScene scene;
  scene.add(PunctualLight::Kind::directional, Rgb(1000.0f), {}, {0, -1, 0});
  scene.add(PunctualLight::Kind::point, Rgb(1.0f), {1, 0, 0}, {});
  scene.add(PunctualLight::Kind::point, Rgb(1000.0f), {2, 0, 0}, {});
  for (std::uint32_t i = 0; i < 3; ++i) scene.frame.lights[i].node = i;
  const Lights alike = scene.lights().placed_alike();
  const double weak = 0.5 * (1.0 / 1001 + 0.5);
  EXPECT_EQ(alike.slots()[0].probability, 0);
  EXPECT_NEAR(alike.slots()[1].probability, weak, 1e-6);
  EXPECT_NEAR(alike.slots()[2].probability, 1 - weak, 1e-6);
  const PhotonEmission first = alike.emit({0.5 * weak, 0.3, 0.4, 0.5});
  EXPECT_EQ(first.slot, 1u);
  EXPECT_NEAR(double(first.flux.r) * weak, 4 * kPiD, 1e-4);
}

}  // namespace
}  // namespace tempolux
