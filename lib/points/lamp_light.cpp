#include "lib/points/lamp_light.h"

#include <optional>

#include "lib/core/parallel_each.h"
#include "lib/core/random.h"
#include "lib/core/sobol.h"
#include "lib/material/seen_side.h"
#include "lib/material/surface_material.h"
#include "lib/transport/media.h"

namespace tempolux {
namespace {

constexpr std::size_t kFewest = 1 << 15, kMost = 1 << 18;  ///< limits of the number of emitted photons
constexpr std::size_t kEnough = 1 << 10;  ///< photons that must land: the relative error of their sum is then 3 %
constexpr std::uint64_t kKey = 0x6c616d7073706f74ull;

/// Where a photon lands, if it meets a Lambert lobe within `reach` [m]. It may pass panes on its way. Its flux [W] is
/// that of the only photon of a map.
std::optional<LampPhoton> landed(const Tracer& tracer, const PointLookup& points, PhotonEmission emission, float reach,
                                 const PathRandom& random) {
  if (is_black(emission.flux)) return std::nullopt;
  // A surface inside of a lamp that is a sphere: the photon becomes one of the two that PhotonEmission::chord names.
  if (emission.chord > 0) [[unlikely]] {
    const Vec3 far_side = emission.origin - emission.travel * emission.chord;
    if (Hit inside; tracer.intersect({far_side, emission.travel, 0, emission.chord}, inside)) {
      emission.flux *= 2;
      if (random.get1(0, Purpose::light_choice) < 0.5f) {
        emission.origin = far_side;
        reach = std::min(reach, emission.chord);
      }
    }
  }
  Ray ray{emission.origin + emission.normal * emission.origin_offset, emission.travel, 0, reach};
  Hit hit;
  SurfacePoint place;
  Rgb flux = emission.flux;
  for (std::uint32_t panes = 0;; ++panes) {
    if (!tracer.intersect(ray, hit)) return std::nullopt;
    place = tracer.surface_point(hit);
    const Rgb passed = passed_straight(tracer.frame(), place, emission.travel);
    if (is_black(passed)) break;
    const float p = max_component(passed);
    if (!(random.get1(panes, Purpose::lobe) < p)) {
      flux *= 1 / (1 - p);
      break;
    }
    flux *= passed / p;
    pass_surface(place, hit.t, ray);
  }
  const SurfaceMaterial material(tracer.frame(), place);
  const Vec3 wi = -emission.travel;
  const bool front = dot(place.normal_geometric, wi) > 0;
  const Vec3 normal = front ? place.normal_geometric : -place.normal_geometric;
  const Vec3 shading = face_forward(place.normal, normal);
  const Bsdf bsdf(material, front, Frame(shading));
  if (!bsdf.has_diffuse()) return std::nullopt;
  const float cosine = dot(wi, shading), geometric = dot(wi, normal);
  const float distance = length(place.position - emission.origin);
  if (!(cosine > 0 && geometric > 0 && distance > 0 && distance < reach)) return std::nullopt;
  const PointLookup::Light* const point = points.find(place.position, normal);
  flux *= cosine / geometric;
  if (const Media* const media = tracer.frame().media.get()) [[unlikely]] {
    const Ray way{ray.origin, ray.direction, 0, hit.t};
    flux *= media_transmittance(*media, way, {random, 0, way_shadow});
  }
  const float weight = bsdf.has_specular() ? bsdf.arrival_weight(wi, shading) : 1;
  return LampPhoton{place, normal, bsdf, flux * weight, flux, wi, distance, point ? point->point : kNone};
}

}  // namespace

std::vector<LampPhoton> photons_beside_lamps(const Tracer& tracer, const Lights& lights, const PointLookup& points,
                                             std::uint64_t seed) {
  if (!(points.spacing() > 0) || !lights.has_placed()) return {};
  const std::uint64_t key = mix64(seed ^ kKey);
  const Lights lamps = lights.placed_alike();
  const float reach = kBesideLamp * points.spacing();
  std::vector<LampPhoton> all;
  std::size_t done = 0;
  for (std::size_t wanted = kFewest; wanted <= kMost; wanted *= 2) {
    const auto more =
        parallel_found<LampPhoton>(wanted - done, 1024, [&](std::size_t j, std::vector<LampPhoton>& found) {
          const std::size_t i = done + j;
          const Vec2 from = sobol_owen_2d(std::uint32_t(i), key), to = sobol_owen_2d(std::uint32_t(i), mix64(key + 1));
          const PhotonEmission emission = lamps.emit({double(from.x), double(from.y), double(to.x), double(to.y)});
          if (const auto photon = landed(tracer, points, emission, reach, PathRandom(key, i))) found.push_back(*photon);
        });
    all.insert(all.end(), more.begin(), more.end());
    done = wanted;
    if (all.empty() || all.size() >= kEnough) break;
  }
  for (LampPhoton& photon : all) {
    photon.flux *= 1 / float(done);
    photon.arriving *= 1 / float(done);
  }
  return all;
}

std::vector<LampPhoton> note_lamps_beside(const Tracer& tracer, const Lights& lights, PointLookup& points) {
  std::vector<LampPhoton> photons = photons_beside_lamps(tracer, lights, points);
  for (const LampPhoton& photon : photons)
    if (photon.point != kNone) points.note_lamp(photon.point);
  return photons;
}

}  // namespace tempolux
