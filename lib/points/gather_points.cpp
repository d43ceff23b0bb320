#include "lib/points/gather_points.h"

#include <algorithm>

#include "formats/error.h"
#include "lib/points/reachable_area.h"
#include "lib/points/whole_photons.h"
#include "lib/material/surface_material.h"
#include "lib/scene/moving_objects.h"
#include "lib/scene/static_scene.h"
#include "lib/transport/learn_sky.h"

namespace tempolux {
namespace {

/// For each point of `whole`, the share in [0, 1] of its irradiance (all kinds; sum of the channels) that comes from
/// the photons `high`, by the density estimate of estimate_points(). `whole`: points estimated from all photons. The
/// two estimates use different discs, so the share has an error. Light that is divided by the shares stays unbiased,
/// because BrightPoints divides light exactly for any shares. 0 at a point without light.
std::vector<float> shares_of_photons(const Tracer& tracer, const Lights& lights, const formats::PhotonMap& high,
                                     PointOptions options, std::span<const IrradiancePoint> whole) {
  std::vector<float> shares(whole.size(), 0.0f);
  if (high.photons.empty()) return shares;
  std::vector<IrradiancePoint> part(whole.begin(), whole.end());
  options.light_samples = 1;  // photons bring no direct light to the points, and the samples of it are not read
  estimate_points(tracer, lights, high, shift_of(high.header.origin, tracer.frame()), options, part);
  for (std::size_t i = 0; i < whole.size(); ++i) {
    const float all = channel_sum(whole[i].direct) + channel_sum(whole[i].caustic) + channel_sum(whole[i].indirect);
    const float bright = channel_sum(part[i].caustic) + channel_sum(part[i].indirect);
    if (all > 0) shares[i] = std::clamp(bright / all, 0.0f, 1.0f);
  }
  return shares;
}

}  // namespace

Vec3d shift_of(const std::array<double, 3>& origin, const SceneFrame& frame) { return vec_of(origin) - frame.origin; }

bool holds_kind(const std::string& kinds, const std::string& kind) {
  return ("," + kinds + ",").find("," + kind + ",") != std::string::npos;
}

Lights guided_lights(const Tracer& tracer, const Lights& lights, std::span<const IrradiancePoint> points) {
  if (!lights.has_environment()) return lights;
  const float offset = Reach(tracer).offset();
  std::vector<SeenPlace> places;
  for (std::size_t i = 0; i < points.size(); i += points.size() / kSkyPlaces + 1) {
    const Vec3 normal = points[i].normal;
    places.push_back({surface_of(points[i], offset), normal, normal});
  }
  return lights.guided(learn_sky(tracer, lights, places));
}

GatherPoints make_points(const formats::PhotonMap& map, const Tracer& tracer, const Lights& lights,
                         const PointOptions& options) {
  const SceneFrame& frame = tracer.frame();
  const bool caustic = holds_kind(map.header.kinds, "caustic") || !lobes_of(frame).specular;
  PlacedPoints placed = place_points(frame, options);
  GatherPoints result{std::move(placed.points), placed.spacing, caustic ? "direct,caustic,indirect" : "direct,indirect",
                      map.header.history, map.header.emitted_count};
  estimate_points(tracer, guided_lights(tracer, lights, result.points), map, shift_of(map.header.origin, frame),
                  options, result.points);
  return result;
}

DividedGatherPoints make_points(const DividedPhotonMap& map, const Tracer& tracer, const Lights& lights,
                                const PointOptions& options) {
  DividedGatherPoints divided{make_points(map.whole, tracer, lights, options), {}};
  divided.high_shares = shares_of_photons(tracer, lights, map.high, options, divided.whole.points);
  return divided;
}

PointUpdateCounts update_points(const MovedPhotons& light, const Tracer& whole, const Tracer& static_tracer,
                                const Lights& unguided, const PointOptions& options, GatherPoints& points) {
  const SceneFrame& frame = whole.frame();
  const MovingObjects moving(frame);
  const PlacedPoints placed = place_points(frame, options);
  const auto own_points = std::ranges::find_if(placed.points, [&](const auto& p) { return moving.contains(p.object); });
  const auto static_count = std::size_t(own_points - placed.points.begin());
  if (points.points.empty()) points.spacing = placed.spacing;  // without static surfaces any spacing fits
  if (static_count != points.points.size() || placed.spacing != points.spacing)
    throw InputError("--update: its points are not those of --point-count " + std::to_string(options.count) + " (" +
                     std::to_string(points.points.size()) + ", not " + std::to_string(static_count) +
                     "); give the options they were made with, --importance included");
  // A file rounds normals, which would change the light samples, so positions and normals are those of place_points().
  for (std::size_t i = 0; i < static_count; ++i) {
    points.points[i].position = placed.points[i].position;
    points.points[i].normal = placed.points[i].normal;
  }
  // Points that no mover shadows keep the light samples of the static scene, so the guide must be that of the static
  // scene.
  const Lights lights = guided_lights(static_tracer, unguided, points.points);
  const Vec3d dynamic_shift = shift_of(light.moved.header.origin, frame);
  const PhotonMaps maps{light.fixed, light.moved, shift_of(light.fixed.header.origin, frame), dynamic_shift};
  const PointUpdateCounts counts = update_points({whole, static_tracer, lights, maps}, options, points.points);
  // Only the dynamic map has photons on movers.
  formats::PhotonBlock on_movers;
  for (std::size_t i = 0; i < light.moved.photons.size(); ++i)
    if (moving.contains(light.moved.photons[i].object)) append(light.moved, i, light.moved.photons[i], on_movers);
  points.points.insert(points.points.end(), own_points, placed.points.end());
  std::vector<std::uint32_t> own;
  for (std::size_t i = static_count; i < points.points.size(); ++i) own.push_back(std::uint32_t(i));
  estimate_points(whole, lights, {on_movers, dynamic_shift}, options, own, points.points);
  return counts;
}

}  // namespace tempolux
