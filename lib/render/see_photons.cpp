#include "lib/render/see_photons.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "lib/core/parallel_each.h"
#include "lib/core/sampling.h"
#include "lib/core/sobol.h"
#include "lib/material/bsdf.h"
#include "lib/material/surface_material.h"
#include "lib/gather/footprint_density.h"
#include "lib/render/known_light.h"
#include "lib/render/photon_splats.h"
#include "lib/render/places_seen.h"

namespace tempolux {
namespace {

constexpr int kColumns = kPilotColumns, kRows = kPilotRows;  ///< each part has its own mean square of a kind of light
constexpr std::size_t kLooks = kPilotPlaces;                 ///< camera rays that follow mirrors and glass

/// A photon's contribution to the mean radiance of the picture, and its position in the picture.
struct SeenFlux {
  double radiance = 0;
  std::size_t cell = 0;
  double noise = 0;  ///< through mirrors and glass: the same sum with the random signs of light paths
};

/// x, y: place in the picture, in [0, 1).
std::size_t cell_at(double x, double y) {
  const auto cell = [](double at, int cells) { return std::size_t(std::min(cells - 1.0, at * cells)); };
  return cell(y, kRows) * kColumns + cell(x, kColumns);
}

/// Contribution of photon i, if the camera sees the photon. Nothing is blurred, so the sum over photons is unbiased.
SeenFlux seen_flux(const PhotonSplats& splats, const CameraView& view, const PhotonView& photons, std::size_t i) {
  const std::optional<Splat> splat = splats.splat(photons.photons[i], {}, photons.direction(i));
  if (!splat) return {};
  const auto width = std::uint32_t(view.width()), height = std::uint32_t(view.height());
  return {double(channel_mean(splat->radiance)) / (double(width) * height),
          cell_at((splat->pixel % width + 0.5) / width, (splat->pixel / width + 0.5) / height)};
}

/// The light of a place that camera ray i of kLooks reaches through mirrors and glass, by a density of photons.
SeenFlux seen_behind(const RenderScene& scene, const FootprintDensity& density, std::optional<SeenPoint> seen, Vec2 u) {
  if (!seen) return {};
  const Vec3 normal = seen->surface.normal_geometric;
  const bool front = dot(normal, seen->normal) > 0;
  const SurfaceMaterial material(scene.frame(), seen->surface, seen->footprint);
  const Bsdf bsdf(material, front);
  const Rgb weight = seen->passed * bsdf.diffuse_albedo() * (kInvPi / float(kLooks));
  const FootprintLight light =
      density.estimate(seen->surface.position, {front ? normal : -normal, seen->normal, seen->normal, &bsdf});
  return {channel_mean(weight * light.irradiance), cell_at(u.x, u.y), channel_mean(weight * light.noise)};
}

/// Place of camera ray i of kLooks in the picture, in [0, 1).
Vec2 look_at(std::size_t i) { return sobol_owen_2d(std::uint32_t(i), 0); }

/// The places that camera rays reach through mirrors and glass, by ray; empty if no ray does.
std::vector<std::optional<SeenPoint>> places_behind(const RenderScene& scene, const CameraView& view) {
  std::vector<std::optional<SeenPoint>> places(kLooks);
  parallel_each(kLooks, 64, [&](std::size_t i) {
    const Vec2 at = look_at(i);
    const Look look{at.x * float(view.width()), at.y * float(view.height()), PathRandom(kLooks, i)};
    places[i] = seen_through(scene.tracer, view, look);
    if (places[i] && !places[i]->by_choice) places[i].reset();
  });
  if (std::ranges::none_of(places, [](const auto& place) { return place.has_value(); })) places.clear();
  return places;
}

std::vector<SeenFlux> all_behind(const RenderScene& scene, std::span<const std::optional<SeenPoint>> places,
                                 const PhotonView& photons, formats::PathKind kind) {
  if (places.empty()) return {};
  const FootprintDensity density(scene.tracer, photons, {.asked = 8}, kind_bit(kind));
  std::vector<SeenFlux> behind(density.empty() ? 0 : places.size());
  parallel_each(behind.size(), 64,
                [&](std::size_t i) { behind[i] = seen_behind(scene, density, places[i], look_at(i)); });
  return behind;
}

/// Joins what is seen directly, by photon, and behind mirrors and glass, by camera ray.
SeenPhotons joined(std::span<const SeenFlux> seen, std::span<const SeenFlux> behind) {
  SeenPhotons pilot;
  std::vector<double> cells(kRows * kColumns, 0.0), noise(kRows * kColumns, 0.0);
  double squares = 0, squares_behind = 0;
  for (const SeenFlux& one : seen) {
    pilot.mean += one.radiance;
    squares += one.radiance * one.radiance;
    cells[one.cell] += one.radiance;
  }
  for (const SeenFlux& one : behind) {
    pilot.mean += one.radiance;
    cells[one.cell] += one.radiance;
    noise[one.cell] += one.noise;
  }
  for (const double cell : noise) squares_behind += cell * cell;
  pilot.mean_error = std::sqrt(squares + squares_behind);
  for (const double cell : cells) pilot.square += cell * cell * double(cells.size());
  return pilot;
}

}  // namespace

SeenLight see_photons(const RenderScene& scene, const CameraView& view, const PhotonView& photons) {
  const std::vector<std::optional<SeenPoint>> places = places_behind(scene, view);
  const PhotonSplats splats(scene.tracer, view);
  const auto of_kind = [&](formats::PathKind kind) {
    std::vector<SeenFlux> seen(photons.photons.size());
    parallel_each(photons.photons.size(), 64, [&](std::size_t i) {
      if (photons.photons[i].kind == kind) seen[i] = seen_flux(splats, view, photons, i);
    });
    return joined(seen, all_behind(scene, places, photons, kind));
  };
  return {of_kind(formats::PathKind::caustic), of_kind(formats::PathKind::indirect)};
}

}  // namespace tempolux
