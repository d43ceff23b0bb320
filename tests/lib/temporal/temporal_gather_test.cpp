// Kept hemispheres over time: they follow changes of light and surfaces, stay the same otherwise, and lose no light.
#include "lib/temporal/temporal_gather.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <memory>
#include <optional>

#include "tests/support/scenes.h"

namespace tempolux {
namespace {

using test::HandMadeScene;
using test::matte;

/// A floor, 4 m wide, and above it, at 0.6 m, a flat square of half-width `half` m that turns about the axis z. The
/// square reflects radiance 1 towards the floor: reflectance 1, irradiance pi. All other surfaces are black.
struct Turning {
  HandMadeScene scene;
  std::vector<IrradiancePoint> points;

  Turning(float angle, float half) {
    scene.add_quad({-2, 0, 2}, {2, 0, 2}, {2, 0, -2}, {-2, 0, -2}, matte(Rgb(0.0f)));
    const float c = half * std::cos(angle), s = half * std::sin(angle);
    scene.add_quad({-c, 0.6f - s, half}, {c, 0.6f + s, half}, {c, 0.6f + s, -half}, {-c, 0.6f - s, -half},
                   matte(Rgb(1.0f)), true);
    for (const float side : {1.0f, -1.0f}) {
      IrradiancePoint point;
      point.position = {0, 0.6f, 0};
      point.normal = Vec3{-std::sin(angle), std::cos(angle), 0} * side;
      point.object = 1;
      point.indirect = Rgb(kPi);
      points.push_back(point);
    }
  }
};

/// Gathering of one frame. A point may represent all surfaces that face the same way.
struct Gathering {
  const SceneFrame& frame;
  Tracer tracer;
  Lights lights;
  PointLookup lookup;
  TemporalGather gather;

  Gathering(HandMadeScene& scene, std::span<const IrradiancePoint> points, const SceneFrame* before,
            const GatherOptions& rays, const PlacementOptions& placement, const TemporalOptions& options = {},
            std::function<std::optional<Vec3>(Vec3)> eye = {})
      : frame(scene.frame()),
        tracer(frame),
        lights(frame, EmissionTable{}),
        lookup(points, 1),
        gather({tracer, lights, lookup, points, anchored_points(frame, points), before, {}, {}, std::move(eye)}, rays,
               placement, options, 8) {}

  /// Pixel (x, y) sees a place of the floor around the origin; neighbouring places are `step` m apart.
  PixelView floor(float step) const {
    return [this, step](const Look& look) -> std::optional<SeenPoint> {
      Hit hit;
      if (!tracer.intersect({{0.3f + step * look.x, 0.1f, step * look.y}, {0, -1, 0}}, hit)) return std::nullopt;
      return SeenPoint{tracer.surface_point(hit), {0, 1, 0}, 1e-9f, false};
    };
  }
};

/// Radii so small that each place gets its own record.
PlacementOptions everywhere() {
  PlacementOptions options;
  options.error_bound = 1e-6f;
  return options;
}

struct Mean {
  double mean = 0, error = 0;  ///< of the mean
};
Mean mean_of(const KeptHemispheres& kept) {
  double sum = 0, square = 0;
  for (const KeptHemisphere& k : kept.records) {
    const double e = double(k.record.irradiance[1]);
    sum += e, square += e * e;
  }
  const double n = double(kept.records.size());
  return {sum / n, std::sqrt(std::max(0.0, square / n - sum / n * (sum / n)) / n)};
}

// A square turns by 1.5 degrees per frame for 200 frames. The mean irradiance of 1000 places below it equals that of
// fresh gathering within 3 standard errors of both. Seen to fail with either of two mistakes. If cells that are
// traced again get a new direction, rays that hit the square are replaced: 29 to 75 % of its light is lost. If these
// cells are left out when cells are drawn by age, rays that have come to hit the square stay: 33 to 70 % too much.
// The square's box fills 0.9 % of the hemisphere, so some of 512 rays always hit it. With 64 rays most records would
// come to a state in which no ray hits the box, and would keep all their directions.
TEST(TemporalGather, ASlowlyTurningObjectKeepsItsShare) {
  constexpr int kWidth = 40, kHeight = 25, kFrames = 200;
  for (const float half : {0.06f, 0.15f}) {
    const GatherOptions rays{.rays = 512};
    KeptHemispheres kept;
    std::uint64_t aged = 0;
    std::unique_ptr<Turning> before;
    for (int f = 0; f <= kFrames; ++f) {
      auto now = std::make_unique<Turning>(float(f) * 0.026f, half);
      const Gathering gathering(now->scene, now->points, before ? &before->scene.frame() : nullptr, rays, everywhere());
      TemporalCounts counts;
      if (before) gathering.gather.advance(kept, counts);
      if (f == 0 || f == kFrames) {
        RecordStore store;
        gathering.gather.place({gathering.floor(1e-4f), f == 0 ? kWidth : 1, f == 0 ? kHeight : 1}, kept, store,
                               counts);
      }
      before = std::move(now);
      ASSERT_GE(kept.records.size(), std::size_t(kWidth * kHeight));
      aged += counts.aged;
    }
    Turning last(float(kFrames) * 0.026f, half);
    GatherOptions other = rays;
    other.seed = 99;
    const Gathering fresh(last.scene, last.points, nullptr, other, everywhere());
    KeptHemispheres anew;
    RecordStore store;
    TemporalCounts counts;
    fresh.gather.place({fresh.floor(1e-4f), kWidth, kHeight}, anew, store, counts);
    const Mean a = mean_of(kept), b = mean_of(anew);
    EXPECT_NEAR(a.mean, b.mean, 3 * std::hypot(a.error, b.error)) << half;
    EXPECT_GT(aged, 0u);
  }
}

/// A closed room, 2 m wide, of reflectance 1/2. All points have the same irradiance E, so each ray returns the
/// radiance E / (2 pi).
struct Room {
  HandMadeScene scene;
  std::vector<IrradiancePoint> points;
  explicit Room(float irradiance) {
    scene.add_room({-1, -1, -1}, {1, 1, 1}, matte(Rgb(0.5f)));
    for (const Vec3 n : {Vec3{1, 0, 0}, Vec3{-1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, -1, 0}, Vec3{0, 0, 1}, Vec3{0, 0, -1}}) {
      IrradiancePoint point;
      point.position = n * -1.0f;
      point.normal = n;
      point.indirect = Rgb(irradiance, 2 * irradiance, 0);
      points.push_back(point);
    }
  }
};

KeptHemispheres kept_in(Room& room, TemporalCounts& counts) {
  const Gathering gathering(room.scene, room.points, nullptr, {.rays = 200}, everywhere());
  KeptHemispheres kept;
  RecordStore store;
  gathering.gather.place(
      {[&](const Look& look) {
         Hit hit;
         gathering.tracer.intersect({{0.1f * look.x, 0, 0.1f * look.y}, {0, -1, 0}}, hit);
         return std::optional(SeenPoint{gathering.tracer.surface_point(hit), {0, 1, 0}, 1e-9f, false});
       },
       4, 4},
      kept, store, counts);
  return kept;
}

KeptHemispheres advanced(Room& before, Room& now, KeptHemispheres kept, TemporalCounts& counts,
                         const TemporalOptions& options = {}) {
  const Gathering gathering(now.scene, now.points, &before.scene.frame(), {.rays = 200}, everywhere(), options);
  gathering.gather.advance(kept, counts);
  RecordStore store;
  gathering.gather.place({[](const Look&) { return std::optional<SeenPoint>(); }, 1, 1}, kept, store, counts);
  return kept;
}

TEST(TemporalGather, WhatStandsStaysToTheBitWithoutARay) {
  Room room(3), same(3);
  TemporalCounts counts, later;
  const KeptHemispheres kept = kept_in(room, counts);
  ASSERT_EQ(kept.records.size(), 16u);
  const KeptHemispheres next = advanced(room, same, kept, later);
  EXPECT_EQ(later.update.rays + later.birth.rays, 0u);
  EXPECT_EQ(later.kept, 16u);
  ASSERT_EQ(next.records.size(), 16u);
  for (std::size_t i = 0; i < 16; ++i) {
    EXPECT_EQ(next.records[i].record, kept.records[i].record);
    EXPECT_EQ(next.records[i].samples, kept.records[i].samples);
    EXPECT_EQ(next.records[i].anchors, kept.records[i].anchors);
  }
}

// Light grows by 1/2 % per frame for 24 frames: E grows by 1.005^24 = 1.127. Each step is far smaller than that of a
// mantissa, 1/128 to 1/256; if mantissas were rounded down, cells would keep their value for the ten frames that they
// live. 16 records of 200 cells have 24 roundings with errors of up to half a step: 0.4 % x sqrt(24 / 3200) = 0.03 %.
// A tenth of the cells is traced per frame, in the second case none.
TEST(TemporalGather, AnchoredCellsFollowTheirPointsLittleByLittle) {
  for (const float refresh : {0.1f, 0.0f}) {
    auto before = std::make_unique<Room>(3.0f);
    TemporalCounts counts;
    KeptHemispheres kept = kept_in(*before, counts);
    const double first = mean_of(kept).mean;
    EXPECT_NEAR(first, 3, 3 * 0.0005);  // rho E = 0.5 x 6
    for (int f = 1; f <= 24; ++f) {
      auto now = std::make_unique<Room>(3 * std::pow(1.005f, float(f)));
      TemporalCounts later;
      kept = advanced(*before, *now, std::move(kept), later, {.refresh = refresh});
      EXPECT_EQ(later.moved + later.lost + later.unanchored, 0u);
      EXPECT_NEAR(double(later.aged), double(refresh) * double(later.cells), 16);
      before = std::move(now);
    }
    EXPECT_NEAR(mean_of(kept).mean / first, std::pow(1.005, 24), 0.001) << refresh;
    for (const KeptHemisphere& k : kept.records) EXPECT_EQ(k.record.irradiance[2], 0);  // black stays black
  }
}

// Scaling mantissas in place gives the same bytes as storing the scaled radiance, with the same random numbers.
TEST(KeptHemisphere, ScalingInPlaceIsKeepingTheProduct) {
  KeptHemisphere a;
  a.record.key = 99;
  a.samples.resize(1);
  int in_place = 0;
  for (int i = 0; i < 20000; ++i) {
    const float x = std::exp2(0.01f * float(i % 4000) - 20);
    a.record.updates = std::uint32_t(i);
    keep_radiance(a, 0, Rgb(x, 0.7f * x, float(i % 3) * x));
    KeptHemisphere b = a;
    const Rgb ratio(0.5f + 1.5f * float(i % 101) / 101, 0.5f + 1.5f * float(i % 31) / 31,
                    0.5f + 1.5f * float(i % 7) / 7);
    const std::array<float, 3> old = formats::decode_rgbe(a.samples[0].rgbe);
    in_place += a.samples[0].rgbe[3] > 0;
    scale_radiance(a, 0, ratio);
    keep_radiance(b, 0, Rgb(old[0], old[1], old[2]) * ratio);
    ASSERT_EQ(a.samples[0].rgbe, b.samples[0].rgbe) << i;
  }
  EXPECT_GT(in_place, 10000);
  scale_radiance(a, 0, Rgb(0.0f));
  EXPECT_EQ(a.samples[0].rgbe, (std::array<std::uint8_t, 4>{}));
}

// A cell with a close hit has the light of two points: that of the hit, and that at which its continued ray ended.
// Scaled by the change of either point, the cell would be wrong by up to 24 %. Here the ceiling becomes 1.9 times as
// bright, and for eight more frames the light of a wall changes slightly. Within these frames each such cell is
// traced again once, and then equals the value that tracing all cells gives. Two roundings of mantissas are 1/128
// each, at most 2 %; the wall's light changes by a thousandth in eight frames.
TEST(TemporalGather, NearHitsAreTracedAgainInTurn) {
  const auto lit = [](float ceiling, float wall) {
    auto room = std::make_unique<Room>(1.0f);
    for (IrradiancePoint& point : room->points) point.caustic = Rgb(1.0f), point.radius = 0.6f;
    for (Rgb IrradiancePoint::*part : {&IrradiancePoint::indirect, &IrradiancePoint::caustic})
      room->points[3].*part *= ceiling, room->points[0].*part *= wall;
    return room;
  };
  auto before = lit(1, 1);
  TemporalCounts counts;
  KeptHemispheres kept = kept_in(*before, counts);
  std::uint64_t cells = 0, traced = 0;
  for (const KeptHemisphere& k : kept.records)
    cells += std::uint64_t(std::count_if(k.samples.begin(), k.samples.end(), [](const formats::RadianceSample& s) {
      return (s.flags & formats::sample_near) && (s.flags & formats::sample_anchored);
    }));
  ASSERT_GT(cells, 100u);
  for (int f = 0; f <= 8; ++f) {
    auto now = lit(1.9f, 1 + 1e-4f * float(f));
    TemporalCounts later;
    kept = advanced(*before, *now, std::move(kept), later, {.refresh = 0});
    if (f > 0) traced += later.near;
    before = std::move(now);
  }
  EXPECT_EQ(traced, cells);
  auto thrice = lit(5.7f, 3);  // all cells are traced again
  for (IrradiancePoint& point : thrice->points)
    if (&point != &thrice->points[3] && &point != &thrice->points[0]) point.indirect *= 3, point.caustic *= 3;
  TemporalCounts later;
  const KeptHemispheres exact = advanced(*before, *thrice, kept, later, {.refresh = 0});
  EXPECT_EQ(later.lost + later.unanchored, later.cells);
  for (std::size_t i = 0; i < kept.records.size(); ++i)
    for (std::size_t c = 0; c < kept.records[i].samples.size(); ++c) {
      const float is = 3 * formats::decode_rgbe(kept.records[i].samples[c].rgbe)[1],
                  should = formats::decode_rgbe(exact.records[i].samples[c].rgbe)[1];
      EXPECT_NEAR(is, should, 0.02f * should) << i << ' ' << c;
    }
}

// A lamp's light moves from one wall to another within four frames, in addition to constant light. All 30 pairs of
// walls are summed, so the whole does not grow brighter. A cell with a close hit has the light of two points. If the
// brighter of the two were its anchor, a hit on a wall that is still dark would follow another wall and miss that its
// own wall becomes bright: 1.8 % of the light would be lost. With the hit's own point as anchor the other point's
// change is missed, too, but it has no trend: an error of second order remains, .5 %.
TEST(TemporalGather, NearHitsDoNotGoDarkUnderAMovingLamp) {
  constexpr int kFrames = 4;
  const auto lit = [](int from, int to, int f) {
    auto room = std::make_unique<Room>(0.5f);
    for (IrradiancePoint& point : room->points) point.caustic = Rgb(0.0f), point.radius = 0.6f;
    room->points[std::size_t(from)].caustic = Rgb(1 - float(f) / kFrames);
    room->points[std::size_t(to)].caustic += Rgb(float(f) / kFrames);
    return room;
  };
  double over_time = 0, anew = 0;
  for (int way = 0; way < 36; ++way) {
    if (way / 6 == way % 6) continue;
    auto before = lit(way / 6, way % 6, 0);
    TemporalCounts counts;
    KeptHemispheres kept = kept_in(*before, counts);
    for (int f = 1; f <= kFrames; ++f) {
      auto now = lit(way / 6, way % 6, f);
      TemporalCounts later;
      kept = advanced(*before, *now, std::move(kept), later, {.refresh = 0});
      before = std::move(now);
    }
    TemporalCounts last;
    over_time += mean_of(kept).mean;
    anew += mean_of(kept_in(*before, last)).mean;
  }
  EXPECT_NEAR(over_time / anew, 1, 0.01);
}

// A plate comes down to 1 cm above a record and hides it from the camera: the smallest radius, 4 pixels of 2.5 cm, no
// longer applies. It still applies if the camera sees the record, if there is no camera, and if the record was hidden
// in a corner from the start.
TEST(TemporalGather, WhatIsHiddenAndCloseHasNoSmallestRadius) {
  const auto stage = [](float height) {
    auto scene = std::make_unique<HandMadeScene>();
    scene->add_quad({-2, 0, 2}, {2, 0, 2}, {2, 0, -2}, {-2, 0, -2}, matte(Rgb(0.5f)));
    scene->add_quad({-1, height, -1}, {1, height, -1}, {1, height, 1}, {-1, height, 1}, matte(Rgb(0.5f)), true);
    return scene;
  };
  PlacementOptions placement;
  const float smallest = placement.min_radius_px * 0.025f;
  const auto radius = [&](float born_below, float eye_height) {
    const auto first = stage(born_below), second = stage(0.01f);
    const std::vector<IrradiancePoint> none;
    KeptHemispheres kept;
    TemporalCounts counts;
    RecordStore store;
    const Gathering start(*first, none, nullptr, {.rays = 200}, placement);
    start.gather.place({[&](const Look&) {
                          Hit hit;
                          EXPECT_TRUE(start.tracer.intersect({{0, 0.005f, 0}, {0, -1, 0}}, hit));
                          return std::optional(SeenPoint{start.tracer.surface_point(hit), {0, 1, 0}, 0.025f, false});
                        },
                        1, 1},
                       kept, store, counts);
    std::function<std::optional<Vec3>(Vec3)> eye;
    if (eye_height > 0) eye = [eye_height](Vec3) { return std::optional<Vec3>({0.001f, eye_height, 0}); };
    const Gathering then(*second, none, &start.frame, {.rays = 200}, placement, {}, eye);
    then.gather.advance(kept, counts);
    EXPECT_EQ(kept.records.size(), 1u);
    return kept.records[0].record.radius;
  };
  EXPECT_LT(radius(1, 3), 0.1f * smallest);
  EXPECT_FLOAT_EQ(radius(1, 0.008f), smallest);
  EXPECT_FLOAT_EQ(radius(1, 0), smallest);
  EXPECT_FLOAT_EQ(radius(0.02f, 3), smallest);
}

// If cells must be traced anyway, age draws at most a quarter of `refresh` of the other cells. Here there are no
// others.
TEST(TemporalGather, WhatMustBeTracedCountsAsRefreshed) {
  Room room(1), brighter(3);
  TemporalCounts counts, later;
  const KeptHemispheres kept = kept_in(room, counts);
  advanced(room, brighter, kept, later, {.refresh = 0.5f});
  EXPECT_EQ(later.lost, later.cells);
  EXPECT_EQ(later.aged, 0u);
}

// If light becomes three times as strong at once, cells are traced again along their old rays, keep their age, and
// are right at once.
TEST(TemporalGather, BeyondHalfAndTwiceCellsAreTracedAgain) {
  Room room(1), brighter(3), dark(0);
  TemporalCounts counts, later, black, back;
  const KeptHemispheres kept = kept_in(room, counts);
  const KeptHemispheres next = advanced(room, brighter, kept, later, {.refresh = 0});
  EXPECT_EQ(later.lost, later.cells);
  EXPECT_NEAR(mean_of(next).mean, 3, 3 * 0.0005);
  for (const KeptHemisphere& k : next.records)
    for (std::uint32_t c = 0; c < k.samples.size(); ++c) {
      EXPECT_EQ(formats::age_of(k.samples[c]), 2);
      EXPECT_EQ(k.draw_of(c), 0u);
    }
  // Lights go out and on again: a cell that was scaled to 0 does not stay 0.
  const KeptHemispheres out = advanced(brighter, dark, next, black, {.refresh = 0});
  EXPECT_EQ(mean_of(out).mean, 0);
  EXPECT_NEAR(mean_of(advanced(dark, room, out, back, {.refresh = 0})).mean, 1, 0.0005);
}

// A record on the square keeps its key and its place in the triangle, and its normal turns with the square.
TEST(TemporalGather, RecordsRideOnWhatMoves) {
  Turning before(0, 0.4f), now(0.5f, 0.4f);
  const Gathering first(before.scene, before.points, nullptr, {.rays = 64}, everywhere());
  KeptHemispheres kept;
  RecordStore store;
  TemporalCounts counts, later;
  first.gather.place({[&](const Look&) {
                        Hit hit;
                        first.tracer.intersect({{0.2f, 2, 0.1f}, {0, -1, 0}}, hit);
                        return std::optional(SeenPoint{first.tracer.surface_point(hit), {0, 1, 0}, 1e-9f, false});
                      },
                      1, 1},
                     kept, store, counts);
  ASSERT_EQ(kept.records.size(), 1u);
  const formats::RadsamplesRecord old = kept.records[0].record;
  EXPECT_EQ(old.set, formats::SurfaceSet::dynamic_set);
  const Gathering second(now.scene, now.points, &before.scene.frame(), {.rays = 64}, everywhere());
  second.gather.advance(kept, later);
  const formats::RadsamplesRecord& r = kept.records[0].record;
  EXPECT_EQ(r.key, old.key);
  EXPECT_NEAR(r.position[0], 0.2f * std::cos(0.5f), 1e-6);
  EXPECT_NEAR(r.position[1], 0.6f + 0.2f * std::sin(0.5f), 1e-6);
  EXPECT_NEAR(r.position[2], 0.1f, 1e-6);
  EXPECT_NEAR(r.normal[0], -std::sin(0.5f), 1e-6);
  EXPECT_NEAR(r.normal[1], std::cos(0.5f), 1e-6);
  EXPECT_EQ(later.moved, kept.records[0].samples.size());  // its surroundings have moved: all cells are traced anew
}

// An object that shrinks to nothing loses its records, and gets new ones when it is back. No record lacks a place,
// and no number is NaN.
TEST(TemporalGather, WhatIsNotThereHasNoRecords) {
  Turning there(0, 0.4f), gone(0.2f, 0), back(0.4f, 0.4f);
  const Gathering first(there.scene, there.points, nullptr, {.rays = 64}, everywhere());
  const auto on_the_square = [](const Gathering& g) {
    return [&g](const Look& look) -> std::optional<SeenPoint> {
      Hit hit;
      if (!g.tracer.intersect({{0.02f * look.x, 2, 0.02f * look.y}, {0, -1, 0}}, hit)) return std::nullopt;
      return SeenPoint{g.tracer.surface_point(hit), {0, 1, 0}, 1e-9f, false};
    };
  };
  KeptHemispheres kept;
  RecordStore store, second_store, third_store;
  TemporalCounts counts, second, third;
  first.gather.place({on_the_square(first), 3, 3}, kept, store, counts);
  ASSERT_EQ(kept.records.size(), 9u);
  const Gathering away(gone.scene, gone.points, &there.scene.frame(), {.rays = 64}, everywhere());
  away.gather.advance(kept, second);
  EXPECT_EQ(second.removed, 9u);
  EXPECT_EQ(kept.records.size(), 0u);
  away.gather.place({on_the_square(away), 3, 3}, kept, second_store, second);  // on the floor
  ASSERT_EQ(kept.records.size(), 9u);
  const Gathering again(back.scene, back.points, &gone.scene.frame(), {.rays = 64}, everywhere());
  again.gather.advance(kept, third);
  EXPECT_EQ(third.removed, 0u);
  EXPECT_GT(third.moved, 0u);  // the square, which is back, blocks rays from the floor
  again.gather.place({on_the_square(again), 3, 3}, kept, third_store, third);
  EXPECT_GE(kept.records.size(), 18u);  // the records of the floor, and new ones
  for (const KeptHemisphere& k : kept.records)
    EXPECT_TRUE(std::isfinite(k.record.irradiance[1]) && std::isfinite(k.record.normal[0]));
}

void expect_same(const KeptHemispheres& a, const KeptHemispheres& b) {
  ASSERT_EQ(a.records.size(), b.records.size());
  for (std::size_t i = 0; i < a.records.size(); ++i) {
    EXPECT_EQ(a.records[i].record, b.records[i].record);
    EXPECT_EQ(a.records[i].samples, b.records[i].samples) << i;
    EXPECT_EQ(a.records[i].anchors, b.records[i].anchors) << i;
  }
}

// Coming back from a file: the same, and going on from it, too.
TEST(TemporalGather, AFileHoldsAllThatCounts) {
  Room room(1), brighter(1.3f);
  TemporalCounts counts, a, b;
  const KeptHemispheres kept = kept_in(room, counts);
  KeptHemispheres again;
  const formats::RadsamplesFile head = head_of(kept);
  for (std::size_t i = 0; i < kept.records.size(); ++i)
    take_samples(head, i, {kept.records[i].samples, kept.records[i].anchors}, {}, again);
  take_head(head, again);
  expect_same(advanced(room, brighter, kept, a), advanced(room, brighter, again, b));
}

}  // namespace
}  // namespace tempolux
