// Time per light sample and per density query, from one light to 10^5, and to build them. JSON on stdout.
#include <algorithm>
#include <cstdio>
#include <ctime>
#include <vector>

#include "lib/core/random.h"
#include "lib/core/sampling.h"
#include "tests/lib/light/light_scene.h"
#include "tests/support/sphere.h"

namespace tempolux {
namespace {

/// `count` small triangles on a sphere of radius 3, facing in; area the same for all.
LightScene ring(int count) {
  LightScene scene;
  const PathRandom random(1, 1);
  std::vector<Vec3> corners;
  for (std::uint32_t i = 0; i < std::uint32_t(count); ++i) {
    const Vec3 n = test::sample_sphere(random.get2(i, Purpose::test));
    const Vec3 a = normalize(cross(n, Vec3{0.3f, 0.5f, 0.9f})) * 0.02f, b = cross(n, a), at = n * 3.0f;
    for (const Vec3 c : {at, at + b, at + a}) corners.push_back(c);
  }
  scene.add(corners, Rgb(1.0f));
  auto& triangles = scene.primitives.back().triangles;
  triangles.clear();
  for (std::uint32_t i = 0; i < std::uint32_t(count); ++i) triangles.push_back({3 * i, 3 * i + 1, 3 * i + 2});
  return scene;
}

LightScene ceiling_lamp() {
  LightScene scene;
  scene.add(square_facing_down({0, 0, 2.8f}, 0.5f), Rgb(1.0f));
  return scene;
}

LightScene bulbs(int count) {
  LightScene scene;
  for (int i = 0; i < count; ++i)
    scene.add(PunctualLight::Kind::point, Rgb(1.0f), {float(i) - 1.5f, 0.5f, 2.5f}, {0, 0, -1});
  return scene;
}

/// Processor time: others on the machine do not count.
double seconds_since(std::clock_t start) { return double(std::clock() - start) / CLOCKS_PER_SEC; }

void measure(const char* name, const LightScene& scene, bool last) {
  const auto before = std::clock();
  const EmissionTable table = scene.table();
  const Lights lights(scene.frame, table);
  const double build = seconds_since(before);
  constexpr std::uint32_t kCount = 1 << 18;
  struct Query {
    Vec3 point;
    float u_choice;
    Vec2 u;
  };
  std::vector<Query> queries;
  const PathRandom random(2, 2);
  for (std::uint32_t i = 0; i < kCount; ++i) {
    const Vec2 place = random.get2(i, Purpose::place);
    queries.push_back({{place.x * 4 - 2, place.y * 4 - 2, 0},
                       random.get1(i, Purpose::light_choice),
                       random.get2(i, Purpose::light_point)});
  }
  double best = 1e9, best_pdf = 1e9, sum = 0;
  for (int run = 0; run < 5; ++run) {
    auto start = std::clock();
    for (const Query& q : queries) {
      LightSample s;
      if (lights.sample(q.point, {0, 0, 1}, q.u_choice, q.u, s)) sum += double(s.facing_irradiance.r * s.wi.z);
    }
    best = std::min(best, seconds_since(start) / kCount);
    if (lights.slots()[0].kind != EmissionSlot::Kind::triangle) continue;
    start = std::clock();
    const std::uint32_t triangles = std::uint32_t(scene.frame.surfaces[0].primitive->triangles.size());
    for (std::uint32_t i = 0; i < kCount; ++i)
      sum += 1e-9 * double(lights.pdf_solid_angle(queries[i].point, {0, 0, 1}, 0, i % triangles,
                                                  scene.frame.surfaces[0].positions[0]));
    best_pdf = std::min(best_pdf, seconds_since(start) / kCount);
  }
  std::printf("  {\"lights\": \"%s\", \"slots\": %zu, \"build_ms\": %.2f, \"sample_ns\": %.1f, ", name, lights.count(),
              build * 1e3, best * 1e9);
  if (best_pdf < 1) std::printf("\"pdf_ns\": %.1f, ", best_pdf * 1e9);
  std::printf("\"mean_irradiance\": %.6g}%s\n", sum / kCount / 5, last ? "" : ",");
}

}  // namespace
}  // namespace tempolux

int main() {
  using namespace tempolux;
  std::printf("[\n");
  measure("one bulb", bulbs(1), false);
  measure("four bulbs", bulbs(4), false);
  measure("ceiling lamp", ceiling_lamp(), false);
  for (const int count : {1, 4, 100, 1000, 10000, 100000}) measure("small triangles", ring(count), count == 100000);
  std::printf("]\n");
}
