// tests/bench/bare_walk.cpp -- the limit of photon-trace: the same random walks with Embree and nothing else.
//
//     bare_walk SCENE [--frame 10] [--photons 4000000] [--threads 2] [--robust yes]
//
// Photons start on the emissive triangles by flux and cosine, are followed by rtcIntersect1 through one tree
// of all triangles at the frame, turn into cosine directions and die by roulette on the albedo, as in
// photon-trace on matte surfaces. Nothing is looked up twice, recorded, checked or repeatable; the generator
// is the cheapest one that will do. --robust yes: no ray slips through an edge (RTC_SCENE_FLAG_ROBUST), as
// in our tools. Prints JSON: seconds of the walk alone (no loading, no building), rays and hits, so that one
// sees that the walks are the same.
#include <embree3/rtcore.h>

#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <exception>
#include <string>
#include <thread>
#include <vector>

#include "lib/core/frame.h"
#include "lib/core/random.h"
#include "lib/core/sampling.h"
#include "lib/scene/gltf_load.h"
#include "lib/scene/at_frame.h"
#include "tests/support/scene_at_frame.h"

namespace {

using namespace tempolux;

struct Emitter {
  Vec3 a, b, c, normal;
  Rgb radiance{0.0f};
  bool two_sided = false;
  double cumulative = 0;  ///< share of the flux of this and all before
};

struct Walk {
  RTCScene tree = nullptr;
  std::vector<Emitter> emitters;
  std::vector<Rgb> albedo;  ///< by geometry
  float offset = 0;         ///< m, off surfaces
};

/// xoroshiro64*: 32 random bits in a few cycles.
struct Generator {
  std::uint32_t a, b;
  explicit Generator(std::uint64_t seed) {
    const std::uint64_t mixed = mix64(seed + 0x9e3779b97f4a7c15ull);
    a = std::uint32_t(mixed) | 1;
    b = std::uint32_t(mixed >> 32);
  }
  float next() {
    const std::uint32_t result = a * 0x9e3779bbu;
    b ^= a;
    a = (a << 26 | a >> 6) ^ b ^ (b << 9);
    b = b << 13 | b >> 19;
    return unit_float(result);
  }
};

Walk make_walk(const SceneFrame& frame, RTCDevice device, bool robust) {
  Walk walk;
  walk.tree = rtcNewScene(device);
  rtcSetSceneFlags(walk.tree, robust ? RTC_SCENE_FLAG_ROBUST : RTC_SCENE_FLAG_NONE);
  double flux = 0;
  for (const Surface& surface : frame.surfaces) {
    const Material& material = frame.materials[surface.material];
    RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
    auto* p = static_cast<Vec3*>(rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                                                         sizeof(Vec3), surface.primitive->positions.size()));
    for (std::uint32_t v = 0; v < surface.primitive->positions.size(); ++v) p[v] = surface.position(v);
    const auto& triangles = surface.primitive->triangles;
    rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, triangles.data(), 0,
                               sizeof triangles[0], triangles.size());
    rtcCommitGeometry(geometry);
    rtcAttachGeometryByID(walk.tree, geometry, unsigned(walk.albedo.size()));
    rtcReleaseGeometry(geometry);
    walk.albedo.push_back(material.base_color * (1 - material.metallic));
    if (!material.emissive()) continue;
    for (const auto& t : triangles) {
      Emitter e{surface.position(t[0]), surface.position(t[1]), surface.position(t[2]), {},
                material.emission,      material.double_sided};
      const Vec3 n = cross(e.b - e.a, e.c - e.a);
      e.normal = normalize(surface.flipped ? -n : n);
      flux += double(length(n)) * double(max_component(e.radiance)) * (e.two_sided ? 2 : 1);
      e.cumulative = flux;
      walk.emitters.push_back(e);
    }
  }
  for (Emitter& e : walk.emitters) e.cumulative /= flux;
  rtcCommitScene(walk.tree);
  walk.offset = 4e-6f * length(frame.bounds.upper - frame.bounds.lower);
  return walk;
}

struct Counts {
  std::uint64_t rays = 0, hits = 0;
  double distance = 0;  ///< so that no ray can be left out
};

void start(const Walk& walk, Generator& random, RTCRay& ray, Rgb& flux) {
  const double u = random.next();
  std::size_t i = 0;
  while (i + 1 < walk.emitters.size() && u >= walk.emitters[i].cumulative) ++i;
  const Emitter& e = walk.emitters[i];
  const Vec2 at = sample_triangle({random.next(), random.next()});
  const Vec3 normal = e.two_sided && random.next() < 0.5f ? -e.normal : e.normal;
  const Vec3 origin = e.a * (1 - at.x - at.y) + e.b * at.x + e.c * at.y + normal * walk.offset;
  const Vec3 travel = Frame(normal).to_world(sample_hemisphere_cos({random.next(), random.next()}));
  ray.org_x = origin.x;
  ray.org_y = origin.y;
  ray.org_z = origin.z;
  ray.dir_x = travel.x;
  ray.dir_y = travel.y;
  ray.dir_z = travel.z;
  flux = e.radiance;
}

void follow(const Walk& walk, Generator& random, Counts& counts) {
  RTCRayHit query{};
  RTCRay& ray = query.ray;
  Rgb flux;
  start(walk, random, ray, flux);
  for (;;) {
    ray.tnear = 0;
    ray.tfar = INFINITY;
    ray.mask = 0xffffffffu;
    query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    rtcIntersect1(walk.tree, &context, &query);
    ++counts.rays;
    if (query.hit.geomID == RTC_INVALID_GEOMETRY_ID) return;
    ++counts.hits;
    counts.distance += double(ray.tfar);
    const Rgb next = flux * walk.albedo[query.hit.geomID];
    const float survival = max_component(next) / max_component(flux);
    if (!(random.next() < survival)) return;
    flux = next * (1 / survival);
    const Vec3 travel{ray.dir_x, ray.dir_y, ray.dir_z};
    Vec3 normal = normalize(Vec3{query.hit.Ng_x, query.hit.Ng_y, query.hit.Ng_z});
    if (dot(normal, travel) > 0) normal = -normal;
    const Vec3 origin = Vec3{ray.org_x, ray.org_y, ray.org_z} + travel * ray.tfar + normal * walk.offset;
    const Vec3 out = Frame(normal).to_world(sample_hemisphere_cos({random.next(), random.next()}));
    ray.org_x = origin.x;
    ray.org_y = origin.y;
    ray.org_z = origin.z;
    ray.dir_x = out.x;
    ray.dir_y = out.y;
    ray.dir_z = out.z;
  }
}

double cpu_seconds() {
  timespec time{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &time);
  return double(time.tv_sec) + 1e-9 * double(time.tv_nsec);
}

double wall_seconds() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

void run(const std::string& scene_file, int frame_number, std::uint64_t photons, unsigned threads, bool robust) {
  const Scene scene = load_gltf(scene_file);
  const TimeOptions time;
  const SceneFrame frame = scene_at_frame(scene, segment_of(scene, frame_number, time), frame_number, time);
  RTCDevice device = rtcNewDevice(nullptr);
  const Walk walk = make_walk(frame, device, robust);
  std::vector<Counts> counts(threads);
  const double cpu = cpu_seconds(), wall = wall_seconds();
  std::vector<std::thread> workers;
  for (unsigned w = 0; w < threads; ++w)
    workers.emplace_back([&, w] {
      Generator random(w);
      Counts mine;
      for (std::uint64_t i = w; i < photons; i += threads) follow(walk, random, mine);
      counts[w] = mine;
    });
  for (std::thread& worker : workers) worker.join();
  const double cpu_s = cpu_seconds() - cpu, wall_s = wall_seconds() - wall;
  Counts all;
  for (const Counts& c : counts) all = {all.rays + c.rays, all.hits + c.hits, all.distance + c.distance};
  using Count = unsigned long long;
  std::printf("{\"photons\": %llu, \"threads\": %u, \"cpu_s\": %.6f, \"wall_s\": %.6f, ", Count{photons}, threads,
              cpu_s, wall_s);
  std::printf("\"rays\": %llu, \"hits\": %llu, \"mean_distance_m\": %.6f}\n", Count{all.rays}, Count{all.hits},
              all.distance / double(all.hits));
  rtcReleaseScene(walk.tree);
  rtcReleaseDevice(device);
}

}  // namespace

int main(int argc, char** argv) {
  std::string scene;
  int frame = 10;
  unsigned threads = 2;
  bool robust = false;
  std::uint64_t photons = 4000000;
  for (int i = 1; i < argc; ++i) {
    const bool valued = i + 1 < argc;
    if (valued && !std::strcmp(argv[i], "--frame")) frame = std::atoi(argv[++i]);
    else if (valued && !std::strcmp(argv[i], "--photons")) photons = std::strtoull(argv[++i], nullptr, 10);
    else if (valued && !std::strcmp(argv[i], "--threads")) threads = unsigned(std::atoi(argv[++i]));
    else if (valued && !std::strcmp(argv[i], "--robust")) robust = !std::strcmp(argv[++i], "yes");
    else scene = argv[i];
  }
  try {
    run(scene, frame, photons, std::max(1u, threads), robust);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "bare_walk: %s\n", error.what());
    return 2;
  }
  return 0;
}
