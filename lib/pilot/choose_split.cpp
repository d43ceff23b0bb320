#include "lib/pilot/choose_split.h"

#include <cstdio>
#include <vector>

#include "lib/core/parallel.h"
#include "lib/density/flux_cells.h"
#include "lib/density/irradiance_estimate.h"
#include "lib/density/split_light.h"
#include "lib/material/bsdf.h"
#include "lib/material/surface_material.h"
#include "lib/pilot/pilot_photons.h"
#include "lib/render/pixel_noise.h"
#include "lib/pilot/places_seen.h"

namespace tempolux {
namespace {

constexpr double kPays = 2;  ///< a split pays above this variance_ratio

}  // namespace

SplitPilot pilot_split(const RenderScene& scene, const CameraView& view, std::uint64_t seed) {
  const std::vector<formats::Photon> photons =
      pilot_photons(scene.tracer, scene.lights, "direct,caustic,indirect", kPilotPaths, seed).photons;
  CellEdge edge;
  for (const formats::Photon& photon : photons) edge.add(place_of(photon).position);
  FluxCells cells(edge.edge(), 0);
  for (const formats::Photon& photon : photons) cells.add(place_of(photon), photon.flux);
  cells.close(kBrightLimit);
  if (cells.bright_count() == 0) return {};
  const PhotonIndex index(photons);
  const SeenPlaces seen = places_seen(scene, view, kPilotPlaces, seed ^ 0x73706c6974ull);
  std::vector<double> all(kPilotPlaces, -1), low(kPilotPlaces, 0);  // by place; -1: there is none
  parallel_chunks(kPilotPlaces, 64, [&](std::size_t first, std::size_t last) {
    NeighbourList found;
    for (std::size_t i = first; i < last; ++i) {
      if (!seen.places[i].exists()) continue;
      all[i] = 0;
      const SeenPlace& met = seen.next_places[i];
      if (!met.exists()) continue;
      SurfacePoint surface = met.surface;
      const SurfaceMaterial material(scene.frame(), surface);
      const Rgb reflected = Bsdf(material, dot(met.surface.normal_geometric, met.geometric) > 0).diffuse_albedo();
      const Rgbd irradiance = estimate_irradiance(index, met.surface.position, met.geometric, {}, found).irradiance;
      all[i] = channel_sum(Rgbd(reflected) * irradiance);
      low[i] = all[i] * cells.low_share({met.surface.position, met.geometric, std::uint16_t(met.surface.object)});
    }
  });
  double count = 0, sum = 0, square = 0, low_sum = 0, low_square = 0;
  for (std::size_t i = 0; i < kPilotPlaces; ++i) {
    if (all[i] < 0) continue;
    ++count;
    sum += all[i], square += all[i] * all[i];
    low_sum += low[i], low_square += low[i] * low[i];
  }
  const double variance = sample_variance(count, sum, square), rest = sample_variance(count, low_sum, low_square);
  if (!(variance > 0)) return {};
  return {rest > 0 ? variance / rest : 1e6, 1 - low_sum / sum};
}

SplitChoice choose_split(const SplitPilot& pilot) {
  char text[160];
  if (pilot.high_share <= 0)
    return {false, "no spot lit by lamps or by reflection lights what is seen by more than 4 times the mean"};
  std::snprintf(
      text, sizeof text,
      "bright spots bring %.0f %% of the light that rays meet; without them its variance is %.2g times smaller",
      100 * pilot.high_share, pilot.variance_ratio);
  return {pilot.variance_ratio > kPays, text};
}

}  // namespace tempolux
