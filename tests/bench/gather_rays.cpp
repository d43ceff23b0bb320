// Gather rays with their look-ups against bare rtcIntersect1: how much of the time of final gathering is Embree's.
//
// The bare side traces the same rays from the records; and for each hit that FinalGather finds too near to read a
// point, as it does, one more ray from there and, as often as it traces one, a shadow ray (rtcOccluded1).
// "bare_over_gather" compares the whole, "first_over_gather" leaves those further rays out of the bare side alone. Rays
// that ask whether a point can be reached count as look-up. The sides alternate; medians. JSON on stdout.
//
//     gather_rays SCENE.glb [--frame F] [--photons N] [--records N] [--rays N]
#include <embree3/rtcore.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <span>
#include <string>
#include <vector>

#include "lib/core/frame.h"
#include "lib/core/random.h"
#include "lib/core/sampling.h"
#include "lib/gather/gather_directions.h"
#include "lib/gather/incoming_radiance.h"
#include "lib/gather/hemisphere.h"
#include "lib/gather/irradiance_points.h"
#include "lib/photon/photon_trace.h"
#include "lib/scene/gltf_load.h"

namespace tempolux {
namespace {

struct Options {
  std::string scene;
  int frame = 10, records = 3000, rays = 500;
  std::uint64_t photons = 200000;
};

double cpu_seconds() {
  timespec time{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &time);
  return double(time.tv_sec) + 1e-9 * double(time.tv_nsec);
}

double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return values[values.size() / 2];
}

RTCRay to_embree(const Ray& ray) {
  RTCRay query{};
  query.org_x = ray.origin.x;
  query.org_y = ray.origin.y;
  query.org_z = ray.origin.z;
  query.dir_x = ray.direction.x;
  query.dir_y = ray.direction.y;
  query.dir_z = ray.direction.z;
  query.tfar = ray.t_max;
  query.mask = 0xffffffffu;
  return query;
}

/// All triangles in one tree, as robust as Tracer's.
RTCScene bare_tree(const SceneFrame& frame, RTCDevice device) {
  RTCScene tree = rtcNewScene(device);
  rtcSetSceneFlags(tree, RTC_SCENE_FLAG_ROBUST);
  for (const Surface& surface : frame.surfaces) {
    const auto& triangles = surface.primitive->triangles;
    RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
    auto* vertices = static_cast<Vec3*>(rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                                                                sizeof(Vec3), surface.primitive->positions.size()));
    for (std::uint32_t v = 0; v < surface.primitive->positions.size(); ++v) vertices[v] = surface.position(v);
    rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, triangles.data(), 0,
                               sizeof triangles[0], triangles.size());
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(tree, geometry);
    rtcReleaseGeometry(geometry);
  }
  rtcCommitScene(tree);
  return tree;
}

/// Stratified cosine rays from points of the lit sides, those of one place one after the other, in the order in which
/// IncomingRadiance follows them.
std::vector<Ray> gather_rays(const Tracer& tracer, const std::vector<IrradiancePoint>& points,
                             const GatherStrata& strata, const Options& options) {
  std::vector<Ray> rays;
  std::vector<const IrradiancePoint*> lit;
  for (const IrradiancePoint& point : points)
    if (max_component(point.total()) > 0) lit.push_back(&point);
  const float offset = Reach(tracer).offset();
  for (int r = 0; r < options.records && !lit.empty(); ++r) {
    const IrradiancePoint& from = *lit[std::size_t(r) * lit.size() / std::size_t(options.records)];
    const Frame frame(from.normal);
    const PathRandom random(1, std::uint64_t(r));
    for (const std::uint32_t cell : strata.order) {
      const Vec2 u = random.get2(cell, Purpose::test);
      const float sin2 = (float(int(cell) / strata.sectors) + u.x) / float(strata.rings);
      const float phi = 2 * kPi * (float(int(cell) % strata.sectors) + u.y) / float(strata.sectors);
      const Vec3 local{std::sqrt(sin2) * std::cos(phi), std::sqrt(sin2) * std::sin(phi), std::sqrt(1 - sin2)};
      rays.push_back({from.position + from.normal * offset, frame.to_world(local), 0, INFINITY});
    }
  }
  return rays;
}

double time_bare(RTCScene tree, const std::vector<Ray>& rays, double& distance) {
  const double start = cpu_seconds();
  for (const Ray& ray : rays) {
    RTCRayHit query{to_embree(ray), {}};
    query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    rtcIntersect1(tree, &context, &query);
    if (query.hit.geomID != RTC_INVALID_GEOMETRY_ID) distance += double(query.ray.tfar);
  }
  return cpu_seconds() - start;
}

double time_bare_shadow(RTCScene tree, const std::vector<Ray>& rays, double& distance) {
  const double start = cpu_seconds();
  for (const Ray& ray : rays) {
    RTCRay query = to_embree(ray);
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    rtcOccluded1(tree, &context, &query);
    distance += query.tfar < 0;
  }
  return cpu_seconds() - start;
}

/// What follows at near hits: cosine rays from the hits of every n-th ray, and shadow rays from some of these. Shares
/// are those of all rays.
struct FurtherRays {
  std::vector<Ray> cosine, shadow;

  FurtherRays(const Tracer& tracer, const Lights& lights, const std::vector<Ray>& rays, double share,
              double shadow_share) {
    for (double next = 0; share > 0 && next < double(rays.size()); next += 1 / share) {
      const std::size_t i = std::size_t(next);
      Hit hit;
      if (!tracer.intersect(rays[i], hit)) continue;
      const SurfacePoint point = tracer.surface_point(hit);
      const Vec3 normal =
          dot(point.normal_geometric, rays[i].direction) > 0 ? -point.normal_geometric : point.normal_geometric;
      const PathRandom random(2, i);
      cosine.push_back(spawn_ray(point, Frame(normal).to_world(sample_hemisphere_cos(random.get2(0, Purpose::test)))));
      LightSample light;
      if (double(shadow.size()) >= shadow_share * double(i + 1)) continue;
      if (lights.sample(point.position, normal, random.get2(1, Purpose::test), light) && dot(light.wi, normal) > 0)
        shadow.push_back(spawn_shadow_ray(point, light.position, light.position_offset));
    }
  }
};

/// CPU seconds to gather along all rays, which are `each` for one place.
double time_gather(const IncomingRadiance& incoming, const std::vector<Ray>& rays, std::size_t each,
                   GatherCounts& counts, double& sum) {
  std::vector<std::uint64_t> keys(rays.size());
  for (std::size_t i = 0; i < keys.size(); ++i) keys[i] = mix64(i);
  std::vector<Rgb> radiance(each);
  std::vector<float> distance(each);
  const double start = cpu_seconds();
  for (std::size_t first = 0; first < rays.size(); first += each) {
    incoming(std::span(rays).subspan(first, each), std::span(keys).subspan(first, each), radiance, distance, counts);
    for (const Rgb& l : radiance) sum += double(l.g);
  }
  return cpu_seconds() - start;
}

void run(const Options& options) {
  const Scene scene = load_gltf(options.scene);
  const TimeOptions time;
  const Segment segment = segment_of(scene, options.frame, time);
  const SceneFrame frame = scene_at_frame(scene, segment, options.frame, time);
  const EmissionTable table = build_emission_table(scene, segment, time);
  const Tracer tracer(frame);
  const Lights lights(frame, table);
  PhotonOptions photon_options;
  photon_options.photon_count = options.photons;
  photon_options.store_direct = false;
  const PhotonTracer photon_tracer(tracer, lights, photon_options);
  std::vector<formats::Photon> photons;
  for (std::size_t b = 0; b < photon_tracer.batch_count(); ++b) {
    const PhotonBatch batch = photon_tracer.trace(b);
    photons.insert(photons.end(), batch.block.photons.begin(), batch.block.photons.end());
  }
  const PointOptions point_options;
  auto [points, spacing] = place_points(frame, point_options);
  const double before = cpu_seconds();
  estimate_points(tracer, lights, photons, {}, point_options, points);
  const double estimate = cpu_seconds() - before;

  RTCDevice device = rtcNewDevice(nullptr);
  RTCScene tree = bare_tree(frame, device);
  const PointLookup first_lookup(points, spacing, point_clearance(tracer));
  const GatherStrata strata(options.rays);
  const std::vector<Ray> rays = gather_rays(tracer, points, strata, options);
  double distance = 0, sum = 0;
  GatherCounts counts;
  time_gather(IncomingRadiance(tracer, lights, first_lookup), rays, strata.cells(), counts, sum);
  const double per_ray = double(counts.rays) / double(rays.size());
  const FurtherRays further(tracer, lights, rays, double(counts.near_hits) / double(rays.size()),
                            double(counts.shadow_rays) / double(rays.size()));
  std::vector<double> bare, bare_first, with_lookup, filling, ratio, ratio_first;
  for (int repeat = 0; repeat < 5; ++repeat) {
    const PointLookup lookup(points, spacing, point_clearance(tracer));
    const IncomingRadiance gather(tracer, lights, lookup);
    bare_first.push_back(time_bare(tree, rays, distance));
    bare.push_back(bare_first.back() + time_bare(tree, further.cosine, distance) +
                   time_bare_shadow(tree, further.shadow, distance));
    filling.push_back(time_gather(gather, rays, strata.cells(), counts, sum));  // fills the look-up's table
    with_lookup.push_back(time_gather(gather, rays, strata.cells(), counts, sum));
    ratio.push_back(bare.back() / filling.back());
    ratio_first.push_back(bare_first.back() / filling.back());
  }
  std::printf(
      "{\"rays\": %zu, \"points\": %zu, \"photons\": %zu, \"estimate_points_cpu_s\": %.4f, \"bare_cpu_s\": %.4f, "
      "\"bare_first_cpu_s\": %.4f, \"gather_cpu_s\": %.4f, \"gather_again_cpu_s\": %.4f, \"bare_over_gather\": %.3f, "
      "\"first_over_gather\": %.3f, \"rays_per_gather_ray\": %.3f, \"shadow_rays_per_gather_ray\": %.3f, "
      "\"mean_distance_m\": %.3f}\n",
      rays.size(), points.size(), photons.size(), estimate, median(bare), median(bare_first), median(filling),
      median(with_lookup), median(ratio), median(ratio_first), per_ray,
      double(further.shadow.size()) / double(rays.size()), distance / double(5 * rays.size()));
  rtcReleaseScene(tree);
  rtcReleaseDevice(device);
}

}  // namespace
}  // namespace tempolux

int main(int argc, char** argv) {
  tempolux::Options options;
  for (int i = 1; i < argc; ++i) {
    const bool valued = i + 1 < argc;
    if (valued && !std::strcmp(argv[i], "--frame")) options.frame = std::atoi(argv[++i]);
    else if (valued && !std::strcmp(argv[i], "--photons")) options.photons = std::strtoull(argv[++i], nullptr, 10);
    else if (valued && !std::strcmp(argv[i], "--records")) options.records = std::max(1, std::atoi(argv[++i]));
    else if (valued && !std::strcmp(argv[i], "--rays")) options.rays = std::max(1, std::atoi(argv[++i]));
    else options.scene = argv[i];
  }
  try {
    tempolux::run(options);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "gather_rays: %s\n", error.what());
    return 2;
  }
  return 0;
}
