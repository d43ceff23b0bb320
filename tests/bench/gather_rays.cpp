// Gather rays with their look-ups against bare rtcIntersect1 on the same rays: how much of the time of final
// gathering is Embree's. The sides alternate; medians. JSON on stdout.
//
//     gather_rays SCENE.glb [--frame F] [--photons N] [--records N] [--rays N]
#include <embree3/rtcore.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <string>
#include <vector>

#include "lib/core/frame.h"
#include "lib/core/random.h"
#include "lib/core/sampling.h"
#include "lib/gather/final_gather.h"
#include "lib/gather/irradiance_points.h"
#include "lib/photon/photon_trace.h"
#include "lib/scene/gltf_load.h"

namespace tempolux {
namespace {

struct Options {
  std::string scene;
  int frame = 10, records = 2000, rays = 800;
  std::uint64_t photons = 100000;
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

/// All triangles in one tree, as robust as Tracer's.
RTCScene bare_tree(const SceneFrame& frame, RTCDevice device) {
  RTCScene tree = rtcNewScene(device);
  rtcSetSceneFlags(tree, RTC_SCENE_FLAG_ROBUST);
  for (const Surface& surface : frame.surfaces) {
    const auto& triangles = surface.primitive->triangles;
    RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
    auto* vertices = static_cast<Vec3*>(rtcSetNewGeometryBuffer(
        geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, sizeof(Vec3), surface.positions.size()));
    std::copy(surface.positions.begin(), surface.positions.end(), vertices);
    rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, triangles.data(), 0,
                               sizeof triangles[0], triangles.size());
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(tree, geometry);
    rtcReleaseGeometry(geometry);
  }
  rtcCommitScene(tree);
  return tree;
}

/// Cosine rays from points of the lit sides, those of one place one after the other.
std::vector<Ray> gather_rays(const Tracer& tracer, const std::vector<IrradiancePoint>& points,
                             const Options& options) {
  std::vector<Ray> rays;
  std::vector<const IrradiancePoint*> lit;
  for (const IrradiancePoint& point : points)
    if (max_component(point.total()) > 0) lit.push_back(&point);
  const float offset = Reach(tracer).offset();
  for (int r = 0; r < options.records && !lit.empty(); ++r) {
    const IrradiancePoint& from = *lit[std::size_t(r) * lit.size() / std::size_t(options.records)];
    const Frame frame(from.normal);
    const PathRandom random(1, std::uint64_t(r));
    for (int i = 0; i < options.rays; ++i)
      rays.push_back({from.position + from.normal * offset,
                      frame.to_world(sample_hemisphere_cos(random.get2(std::uint32_t(i), Purpose::test))), 0,
                      INFINITY});
  }
  return rays;
}

double time_bare(RTCScene tree, const std::vector<Ray>& rays, double& distance) {
  const double start = cpu_seconds();
  for (const Ray& ray : rays) {
    RTCRayHit query{};
    query.ray.org_x = ray.origin.x;
    query.ray.org_y = ray.origin.y;
    query.ray.org_z = ray.origin.z;
    query.ray.dir_x = ray.direction.x;
    query.ray.dir_y = ray.direction.y;
    query.ray.dir_z = ray.direction.z;
    query.ray.tfar = INFINITY;
    query.ray.mask = 0xffffffffu;
    query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    rtcIntersect1(tree, &context, &query);
    if (query.hit.geomID != RTC_INVALID_GEOMETRY_ID) distance += double(query.ray.tfar);
  }
  return cpu_seconds() - start;
}

double time_gather(const FinalGather& gather, const std::vector<Ray>& rays, GatherCounts& counts,
                   double& sum) {
  const double start = cpu_seconds();
  for (std::size_t i = 0; i < rays.size(); ++i) {
    float distance;
    sum += double(gather.radiance(rays[i], i, distance, counts).g);
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
  std::vector<IrradiancePoint> points = place_points(frame, point_options);
  const double before = cpu_seconds();
  estimate_points(tracer, lights, photons, {}, point_options, points);
  const double estimate = cpu_seconds() - before;

  RTCDevice device = rtcNewDevice(nullptr);
  RTCScene tree = bare_tree(frame, device);
  const std::vector<Ray> rays = gather_rays(tracer, points, options);
  std::vector<double> bare, with_lookup, first, ratio;
  double distance = 0, sum = 0;
  GatherCounts counts;
  for (int repeat = 0; repeat < 5; ++repeat) {
    const PointLookup lookup(points, frame.bounds, point_spacing(frame, point_options), point_reach(tracer));
    const FinalGather gather(tracer, lights, lookup, {});
    bare.push_back(time_bare(tree, rays, distance));
    first.push_back(time_gather(gather, rays, counts, sum));  // fills the look-up's table
    counts = {};
    with_lookup.push_back(time_gather(gather, rays, counts, sum));
    ratio.push_back(bare.back() / first.back());
  }
  std::printf(
      "{\"rays\": %zu, \"points\": %zu, \"photons\": %zu, \"estimate_points_cpu_s\": %.4f, \"bare_cpu_s\": "
      "%.4f, "
      "\"gather_cpu_s\": %.4f, \"gather_again_cpu_s\": %.4f, \"bare_over_gather\": %.3f, "
      "\"rays_per_gather_ray\": %.3f, \"mean_distance_m\": %.3f, \"mean_radiance\": %.5f}\n",
      rays.size(), points.size(), photons.size(), estimate, median(bare), median(first), median(with_lookup),
      median(ratio), double(counts.rays) / double(rays.size()), distance / double(5 * rays.size()),
      sum / double(10 * rays.size()));
  rtcReleaseScene(tree);
  rtcReleaseDevice(device);
}

}  // namespace
}  // namespace tempolux

int main(int argc, char** argv) {
  tempolux::Options options;
  for (int i = 1; i < argc; ++i) {
    const bool valued = i + 1 < argc;
    if (valued && !std::strcmp(argv[i], "--frame"))
      options.frame = std::atoi(argv[++i]);
    else if (valued && !std::strcmp(argv[i], "--photons"))
      options.photons = std::strtoull(argv[++i], nullptr, 10);
    else if (valued && !std::strcmp(argv[i], "--records"))
      options.records = std::max(1, std::atoi(argv[++i]));
    else if (valued && !std::strcmp(argv[i], "--rays"))
      options.rays = std::max(1, std::atoi(argv[++i]));
    else
      options.scene = argv[i];
  }
  try {
    tempolux::run(options);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "gather_rays: %s\n", error.what());
    return 2;
  }
  return 0;
}
