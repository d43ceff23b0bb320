#include "lib/pilot/see_photons.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "lib/core/parallel_each.h"
#include "lib/core/sampling.h"
#include "lib/core/sobol.h"
#include "lib/material/bsdf.h"
#include "lib/material/surface_material.h"
#include "lib/points/footprint_density.h"
#include "lib/points/reachable_area.h"
#include "lib/render/known_light.h"
#include "lib/audit/photon_splats.h"
#include "lib/pilot/places_seen.h"
#include "lib/transport/shading.h"

namespace tempolux {
namespace {

constexpr std::size_t kLooks = kPilotPlaces;  ///< number of camera rays that follow mirrors and glass

/// Light that a photon or a camera ray adds to the picture.
struct SeenFlux {
  double radiance = 0;   ///< contribution to the mean radiance of the picture [W/m^2/sr]
  std::size_t part = 0;  ///< pilot_part
  double noise = 0;      ///< of a camera ray: noise of `radiance` (FootprintLight::noise)
};

/// Contribution of photon i; 0 if the camera does not see the photon. The sum over photons is unbiased (PhotonSplats).
SeenFlux seen_flux(const PhotonSplats& splats, const CameraView& view, const PhotonView& photons, std::size_t i) {
  const std::optional<Splat> splat = splats.splat(photons.photons[i], {}, photons.direction(i));
  if (!splat) return {};
  const auto width = std::uint32_t(view.width()), height = std::uint32_t(view.height());
  return {double(channel_mean(splat->radiance)) / (double(width) * height),
          pilot_part((splat->pixel % width + 0.5) / width, (splat->pixel / width + 0.5) / height)};
}

/// Light of a place that a camera ray has reached through mirrors and glass, estimated from the density of photons. u:
/// position of the ray in the picture, in [0, 1)^2.
SeenFlux seen_behind(const RenderScene& scene, const FootprintDensity& density, std::optional<SeenPoint> seen, Vec2 u) {
  if (!seen) return {};
  const Vec3 normal = seen->surface.normal_geometric;
  const bool front = dot(normal, seen->normal) > 0;
  const SurfaceMaterial read(scene.frame(), seen->surface, seen->footprint);
  const MaterialValues material = seen->far_side ? on_far_side(read) : read.values();
  const Bsdf bsdf(material, front, Frame(seen->normal));
  const Rgb weight = seen->passed * bsdf.diffuse_albedo() * (kInvPi / float(kLooks));
  const FootprintLight light =
      density.estimate(seen->surface.position, {front ? normal : -normal, seen->normal, seen->normal, &bsdf});
  return {channel_mean(weight * light.irradiance), pilot_part(double(u.x), double(u.y)),
          channel_mean(weight * light.noise)};
}

/// Position of camera ray i of kLooks in the picture, in [0, 1)^2.
Vec2 look_at(std::size_t i) { return sobol_owen_2d(std::uint32_t(i), 0); }

/// For each of kLooks camera rays, the place that it reaches through mirrors and glass, if any. Empty if no ray reaches
/// such a place.
std::vector<std::optional<SeenPoint>> places_behind(const RenderScene& scene, const CameraView& view) {
  std::vector<std::optional<SeenPoint>> places(kLooks);
  parallel_each(kLooks, 64, [&](std::size_t i) {
    const Vec2 at = look_at(i);
    const Look look{at.x * float(view.width()), at.y * float(view.height()), PathRandom(kLooks, i)};
    places[i] = seen_through(scene.tracer, view, look);
    if (places[i] && !places[i]->mirrored) places[i].reset();
  });
  if (std::ranges::none_of(places, [](const auto& place) { return place.has_value(); })) places.clear();
  return places;
}

/// seen_behind() of all camera rays for one kind of photons.
std::vector<SeenFlux> all_behind(const RenderScene& scene, std::span<const std::optional<SeenPoint>> places,
                                 const PhotonView& photons, formats::PathKind kind) {
  if (places.empty()) return {};
  const FootprintDensity density(scene.tracer, photons, {.asked = kAskedPhotons}, kind_bit(kind));
  std::vector<SeenFlux> behind(density.empty() ? 0 : places.size());
  parallel_each(behind.size(), 64,
                [&](std::size_t i) { behind[i] = seen_behind(scene, density, places[i], look_at(i)); });
  return behind;
}

/// Sums light that is seen directly (by photon) and behind mirrors and glass (by camera ray).
SeenPhotons joined(std::span<const SeenFlux> seen, std::span<const SeenFlux> behind) {
  SeenPhotons pilot;
  std::vector<double> parts(kPilotParts, 0.0), noise(kPilotParts, 0.0), of_photons(kPilotParts, 0.0);
  double squares_behind = 0;
  for (const SeenFlux& one : seen) {
    pilot.mean += one.radiance;
    of_photons[one.part] += one.radiance * one.radiance;
    parts[one.part] += one.radiance;
  }
  double squares = 0;
  for (std::size_t part = 0; part < kPilotParts; ++part) {
    squares += of_photons[part];
    pilot.photons.push_back(of_photons[part] > 0 ? parts[part] * parts[part] / of_photons[part] : 0);
  }
  for (const SeenFlux& one : behind) {
    pilot.mean += one.radiance;
    parts[one.part] += one.radiance;
    noise[one.part] += one.noise;
  }
  for (const double part : noise) squares_behind += part * part;
  pilot.mean_error = std::sqrt(squares + squares_behind);
  for (const double part : parts) {
    pilot.square += part * part * kPilotParts;
    pilot.light.push_back(part * kPilotParts);
  }
  return pilot;
}

/// Traces a path back from the place of a caustic photon along wi. Where the path meets a surface, one light sample is
/// taken by the surface's lobes S. Returns the radiance [W/m^2/sr, mean of the channels] of this sample after the
/// reflection by the Lambert lobe of the photon's place. 0 for a lamp that rays meet, a mirror and smooth glass.
double found_by_path(const RenderScene& scene, const formats::Photon& photon, Vec3 wi, const PathRandom& random) {
  const Vec3 place = vec_of(photon.position);
  const float offset = 4 * Reach(scene.tracer).offset();
  Hit hit;
  if (!scene.tracer.intersect({place + wi * offset, -wi, 0, 2 * offset}, hit)) return 0;
  SurfacePoint at = scene.tracer.surface_point(hit);
  const SurfaceMaterial here(scene.frame(), at);
  const Rgb reflectance = ShadingPoint(at, wi, here).bsdf.diffuse_albedo();
  hit = {};
  if (!scene.tracer.intersect({place + wi * offset, wi, 0, INFINITY}, hit)) return 0;
  SurfacePoint met = scene.tracer.surface_point(hit);
  const SurfaceMaterial there(scene.frame(), met);
  const ShadingPoint lobes(met, -wi, there);
  LightSample light;
  if (!lobes.bsdf.has_specular() || lobes.bsdf.specular_is_delta() ||
      !scene.lights.sample(met.position, lobes.normal, random.get2(0, Purpose::light_point), light) ||
      !light.only_sampled || !lobes.sees(light.wi))
    return 0;
  const Bsdf::Direction from = lobes.bsdf.along(lobes.frame.to_local(light.wi));
  return double(channel_mean(reflectance * lobes.eval_specular(from) * light.facing_irradiance * from.w.z));
}

}  // namespace

std::vector<double> lone_light(const RenderScene& scene, const CameraView& view, const PhotonView& photons,
                               double cut) {
  const PhotonSplats splats(scene.tracer, view, scene.camera_inside);
  std::vector<SeenFlux> lone(photons.photons.size());
  parallel_each(lone.size(), 64, [&](std::size_t i) {
    const formats::Photon& photon = photons.photons[i];
    if (photon.kind != formats::PathKind::caustic) return;
    const SeenFlux seen = seen_flux(splats, view, photons, i);
    if (seen.radiance > 0 && found_by_path(scene, photon, *photons.direction(i), PathRandom(kLooks, i)) > cut)
      lone[i] = seen;
  });
  std::vector<double> parts(kPilotParts, 0.0);
  for (const SeenFlux& one : lone) parts[one.part] += one.radiance * kPilotParts;
  return parts;
}

SeenLight see_photons(const RenderScene& scene, const CameraView& view, const PhotonView& photons) {
  const std::vector<std::optional<SeenPoint>> places = places_behind(scene, view);
  const PhotonSplats splats(scene.tracer, view, scene.camera_inside);
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
