#include "lib/pilot/choose_moving.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <vector>

#include "lib/core/parallel.h"
#include "lib/core/parallel_each.h"
#include "lib/density/photon_index.h"
#include "lib/gather/localised.h"
#include "lib/photon/dynamic_map.h"
#include "lib/pilot/pilot_photons.h"
#include "lib/pilot/places_seen.h"
#include "lib/scene/static_scene.h"

namespace tempolux {
namespace {

/// Number of static photons in a disc in which influence is measured. At the lower threshold, .06, the disc holds
/// .06 x 200 = 12 dynamic photons.
constexpr int kNeighbours = 200;

/// Costs of a state of light over its cost without reuse (docs/methods/dynamic.md). Photons and points: a constant
/// part, and a part that grows with the share of touched paths.
constexpr double kLeastLight = 0.2, kLightByTouched = 3;

float largest(Rgb flux) { return std::max({std::abs(flux.r), std::abs(flux.g), std::abs(flux.b)}); }

/// Sum over the photons of the largest channel of |flux| [W].
double sum(const PhotonIndex& index, const NeighbourList& found) {
  double flux = 0;
  for (const std::uint32_t photon : found.photons()) flux += double(largest(index.flux(photon)));
  return flux;
}

struct PilotMaps {
  std::vector<formats::Photon> fixed;    ///< of the static scene
  std::vector<formats::Photon> dynamic;  ///< the signed change by movers
  std::size_t touched = 0;               ///< number of touched paths
};

PilotMaps trace_maps(const RenderScene& scene, const EmissionTable& emission, std::uint64_t seed) {
  PhotonOptions options{.seed = seed, .photon_count = kPilotPaths, .group_count = 1};
  options.set_kinds("indirect");
  const SceneFrame static_scene = static_scene_of(scene.frame());
  const Tracer fixed_tracer(static_scene);
  const Lights fixed_lights(static_scene, emission);
  const PhotonTracer whole(scene.tracer, scene.lights, options);
  PhotonTracer fixed(fixed_tracer, fixed_lights, options);
  const MoverWatch watch({moving_boxes(scene.frame())});
  fixed.watch(&watch);
  std::vector<PhotonBatch> batches(fixed.batch_count()), changes(batches.size());
  parallel_each(batches.size(), 1, [&](std::size_t b) {
    batches[b] = fixed.trace(b);
    std::vector<std::uint64_t> paths;
    for (const formats::TouchedPath& path : batches[b].touched) paths.push_back(path.path);
    if (!paths.empty()) changes[b] = difference_of(fixed, whole, paths);
  });
  PilotMaps maps;
  for (std::size_t b = 0; b < batches.size(); ++b) {
    maps.touched += batches[b].touched.size();
    for (const formats::Photon& photon : batches[b].block.photons) maps.fixed.push_back(photon);
    for (const formats::Photon& photon : changes[b].block.photons) maps.dynamic.push_back(photon);
  }
  return maps;
}

}  // namespace

MovingPilot pilot_moving(const RenderScene& scene, const EmissionTable& emission, const CameraView& view,
                         std::uint64_t seed) {
  const PilotMaps maps = trace_maps(scene, emission, seed);
  const PhotonIndex fixed(maps.fixed, kind_bit(formats::PathKind::indirect), {}),
      dynamic(maps.dynamic, kind_bit(formats::PathKind::indirect), {});
  const SeenPlaces seen = places_seen(scene, view, kPilotPlaces, seed);
  std::vector<std::uint8_t> gathered(kPilotPlaces, 0);
  parallel_chunks(kPilotPlaces, 64, [&](std::size_t first, std::size_t last) {
    NeighbourList found;
    for (std::size_t i = first; i < last; ++i) {
      const SeenPlace& place = seen.places[i];
      if (!place.exists()) continue;
      gathered[i] = place.surface.surface >= scene.frame().static_count;  // surfaces of movers come last
      PhotonQuery query{place.surface.position, place.normal, INFINITY, kMinCos, kFlattening};
      fixed.find_nearest(query, kNeighbours, found);
      if (gathered[i] || found.count() == 0) continue;
      query.max_radius = std::sqrt(found.distance2()[found.farthest()]);
      const double light = sum(fixed, found);
      dynamic.find_within(query, found);
      gathered[i] = sum(dynamic, found) > double(InfluenceThresholds{}.low) * light;
    }
  });
  const auto places = std::ranges::count_if(seen.places, &SeenPlace::exists),
             all_gathered = std::ranges::count(gathered, 1);
  return {double(maps.touched) / double(kPilotPaths), places > 0 ? double(all_gathered) / double(places) : 0};
}

namespace {

/// MovingChoice::static_ray_factor: f is compared with sqrt(2), squared.
int static_ray_factor(double gathered, double static_records) {
  const double above = (1 - gathered) * (kLeastRecords + gathered), below = static_records * gathered;
  return above >= 2 * below ? 2 : 1;
}

}  // namespace

MovingChoice choose_moving(const MovingPilot& pilot, std::size_t states, double static_records) {
  const double light =
      1 / double(std::max<std::size_t>(states, 1)) + kLeastLight + kLightByTouched * pilot.touched_share;
  const double records = static_records + kLeastRecords + pilot.gathered_share;
  char because[160];
  std::snprintf(
      because, sizeof because,
      "what moves touches %.0f %% of the paths of light and matters at %.0f %% of what is seen; %zu states of light",
      100 * pilot.touched_share, 100 * pilot.gathered_share, states);
  const MovingMethod method = !(light < 1)  ? MovingMethod::anew
                              : records < 1 ? MovingMethod::records
                                            : MovingMethod::light;
  return {method, because,
          method == MovingMethod::records ? static_ray_factor(pilot.gathered_share, static_records) : 1};
}

}  // namespace tempolux
