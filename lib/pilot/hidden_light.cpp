#include "lib/pilot/hidden_light.h"

#include <algorithm>
#include <vector>

#include "lib/core/parallel_each.h"
#include "lib/density/photon_view.h"
#include "lib/material/smooth_material.h"
#include "lib/photon/photon_trace.h"
#include "lib/audit/audit.h"
#include "lib/audit/photon_splats.h"
#include "lib/pilot/pilot_photons.h"
#include "lib/pilot/see_photons.h"

namespace tempolux {
namespace {

/// Number of batches that are traced in parallel before their light is added in order.
constexpr std::size_t kBatchesAtOnce = 256;

}  // namespace

bool may_hide_light(const SceneFrame& frame) {
  return std::ranges::any_of(frame.lights, [](const PlacedLight& l) { return max_component(l.light.intensity) > 0; }) &&
         first_smooth_material(frame) != kNone;
}

bool light_paths_find(const SceneFrame& frame, const EmissionTable& table) {
  const Lights lamps(frame, table, Lights::Which::lamps);
  return (lamps.has_placed() || lamps.has_suns()) && first_smooth_material(frame) != kNone;
}

double hidden_share(const RenderScene& scene, const Lights& without_extent, const CameraView& view, double picture,
                    double least) {
  const formats::PhotonBlock photons = pilot_photons(scene.tracer, without_extent, "caustic", kPilotPaths, 0);
  const SeenPhotons hidden = see_photons(scene, view, photons).caustic;
  const bool sure = hidden.mean - kAuditErrors * hidden.mean_error > least * picture;
  return sure ? hidden.mean / (picture > 0 ? picture : hidden.mean) : 0;
}

void add_hidden_light(const RenderScene& scene, const Lights& lamps, const CameraView& view, std::uint64_t paths,
                      std::uint64_t seed, LayerImage& picture) {
  const PhotonOptions options{
      .seed = seed, .photon_count = paths, .group_count = 1, .store_direct = false, .first_event_smooth = true};
  const PhotonTracer photons(scene.tracer, lamps, options);
  const PhotonSplats camera(scene.tracer, view, scene.camera_inside);
  std::vector<LayersT<double>> sums(picture.pixels.size());
  std::vector<std::vector<Splat>> seen(kBatchesAtOnce);
  for (std::size_t first = 0; first < photons.batch_count(); first += kBatchesAtOnce) {
    const std::size_t count = std::min(kBatchesAtOnce, photons.batch_count() - first);
    parallel_each(count, 1, [&](std::size_t b) {
      const PhotonBatch batch = photons.trace(first + b);
      const PhotonView arrived(batch.block);
      seen[b].clear();
      for (std::size_t i = 0; i < arrived.photons.size(); ++i)
        if (const std::optional<Splat> splat = camera.splat(arrived.photons[i], {}, arrived.direction(i)))
          seen[b].push_back(*splat);
    });
    for (std::size_t b = 0; b < count; ++b)
      for (const Splat& splat : seen[b]) sums[splat.pixel][splat.layer] += Rgbd(splat.radiance);
  }
  for (std::size_t p = 0; p < sums.size(); ++p)
    for (std::size_t l = 0; l < kLayerCount; ++l) picture.pixels[p].value[l] += Rgb(sums[p].value[l]);
}

}  // namespace tempolux
