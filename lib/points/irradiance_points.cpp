#include "lib/points/irradiance_points.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <map>
#include <numeric>
#include <optional>

#include "lib/core/parallel_array.h"
#include "lib/core/parallel_each.h"
#include "lib/core/random.h"
#include "lib/core/sampling.h"
#include "lib/core/sobol.h"
#include "lib/density/morton.h"
#include "lib/material/bsdf.h"
#include "lib/material/inside.h"
#include "lib/material/seen_side.h"
#include "lib/material/surface_material.h"
#include "lib/trace/solid_around.h"
#include "lib/transport/direct_light.h"
#include "lib/transport/media.h"

namespace tempolux {
namespace {

double triangle_area(const Surface& surface, const std::array<std::uint32_t, 3>& t) {
  const Vec3 a = surface.position(t[0]);
  return 0.5 * double(length(cross(surface.position(t[1]) - a, surface.position(t[2]) - a)));
}

bool stores_light(const SceneFrame& frame, const Surface& surface) {
  return may_have_lambert(frame.materials[surface.material]);
}

constexpr std::uint32_t kMostSites = 1u << 30;  ///< per side of a surface

using Areas = ParallelArray<double>;

/// The triangles of a surface, or the pieces of triangles, on which points are placed.
struct Ground {
  std::vector<TrianglePiece> pieces;  ///< empty: all triangles
  Areas areas;                        ///< of each triangle or piece, m^2
};

Ground ground_of(const Surface& surface, std::span<const AimSphere> region) {
  if (region.empty()) {
    const auto& triangles = surface.primitive->triangles;
    Areas areas(triangles.size());
    parallel_each(triangles.size(), 1 << 14, [&](std::size_t i) { areas[i] = triangle_area(surface, triangles[i]); });
    return {{}, std::move(areas)};
  }
  std::vector<TrianglePiece> pieces = pieces_in(surface, region);
  Areas areas(pieces.size());
  for (std::size_t i = 0; i < pieces.size(); ++i) areas[i] = pieces[i].area;
  return {std::move(pieces), std::move(areas)};
}

/// A uniform random point on one side of the ground (`back`: the side from which the triangles' normals point away).
/// `ground.areas` must hold running sums: u.x chooses the piece by area and the first barycentric coordinate, u.y the
/// second. The normal is 0 if the triangle has no area.
IrradiancePoint point_on(const Surface& surface, Ground& ground, Vec2 u, bool back) {
  const std::vector<TrianglePiece>& pieces = ground.pieces;
  const std::span<const double> cumulative = std::span<double>(ground.areas);
  const double along = double(u.x) * cumulative.back();
  const auto at = std::size_t(std::upper_bound(cumulative.begin(), cumulative.end() - 1, along) - cumulative.begin());
  const double first = at ? cumulative[at - 1] : 0, width = cumulative[at] - first;
  const float within = width > 0 ? float(std::clamp((along - first) / width, 0.0, 0.999999)) : 0.5f;
  const auto& t = surface.primitive->triangles[pieces.empty() ? at : pieces[at].triangle];
  const Vec3 a = surface.position(t[0]), b = surface.position(t[1]), c = surface.position(t[2]);
  Vec2 bary = sample_triangle({within, u.y});
  if (!pieces.empty()) {
    const auto& [p, q, r] = pieces[at].corners;
    bary = {p.x + bary.x * (q.x - p.x) + bary.y * (r.x - p.x), p.y + bary.x * (q.y - p.y) + bary.y * (r.y - p.y)};
  }
  IrradiancePoint point;
  point.position = a * (1 - bary.x - bary.y) + b * bary.x + c * bary.y;
  point.normal = normalize(cross(b - a, c - a)) * (back ? -1.0f : 1.0f);
  point.object = surface.object;
  return point;
}

/// Replaces the ground's areas by their running sum. Returns the last one, the area of one side [m^2].
double add_up(Ground& ground) {
  const std::span<double> areas = ground.areas;
  std::partial_sum(areas.begin(), areas.end(), areas.begin());
  return areas.empty() ? 0 : areas.back();
}

/// One side of a surface, on which `count` points are placed.
struct SideOfSurface {
  const Surface& surface;
  Ground& ground;  ///< with running sums of areas
  std::uint32_t count;
  bool back;
};

/// The points of a scrambled Sobol sequence on a side, uniform by area, that have a normal and that `wanted` accepts.
/// `key`: of the sequence.
template <class Wanted>
std::vector<IrradiancePoint> spread(const SideOfSurface& side, std::uint64_t key, const Wanted& wanted) {
  return parallel_found<IrradiancePoint>(side.count, 4096, [&](std::size_t i, std::vector<IrradiancePoint>& found) {
    const Vec2 u = sobol_owen_2d(std::uint32_t(i), key);
    const IrradiancePoint point = point_on(side.surface, side.ground, u, side.back);
    if (length2(point.normal) > 0 && wanted(point.position)) found.push_back(point);
  });
}

/// The spheres in which points are placed: some of the spheres around what cameras see; empty: everywhere. They are
/// chosen by the area of static surfaces, or of movers if no static surface lies in the spheres.
std::vector<AimSphere> region_of_points(const SceneFrame& frame, std::span<const AimSphere> seen) {
  if (seen.empty()) return {};
  std::vector<double> standing(seen.size()), moving(seen.size());
  for (std::size_t i = 0; i < frame.surfaces.size(); ++i) {
    if (!stores_light(frame, frame.surfaces[i])) continue;
    std::vector<double>& areas = i < frame.static_count ? standing : moving;
    for (const TrianglePiece& piece : pieces_in(frame.surfaces[i], seen))
      for (std::size_t k = 0; k < seen.size(); ++k)
        if (piece.spheres >> k & 1) areas[k] += piece.area;
  }
  const bool stands = std::ranges::any_of(standing, [](double area) { return area > 0; });
  return spheres_with_points(seen, stands ? standing : moving);
}

/// True if a material has a Lambert lobe under a coat: light must then be weighted by its direction.
bool any_coated(const SceneFrame& frame) {
  return std::any_of(frame.materials.begin(), frame.materials.end(),
                     [](const Material& m) { return lobes_of(m).lambert && lobes_of(m).specular; });
}

/// True if a shading normal differs from the normal of its triangle by more than half a degree.
bool any_bent(const SceneFrame& frame) {
  return std::any_of(frame.surfaces.begin(), frame.surfaces.end(), [&](const Surface& surface) {
    const Material& material = frame.materials[surface.material];
    if (!may_have_lambert(material)) return false;
    if (material.textures && material.textures->normal) return true;
    if (!surface.smooth()) return false;
    return std::any_of(surface.primitive->triangles.begin(), surface.primitive->triangles.end(), [&](const auto& t) {
      const Vec3 a = surface.position(t[0]);
      const Vec3 n = normalize(cross(surface.position(t[1]) - a, surface.position(t[2]) - a));
      return length2(n) > 0 && std::any_of(t.begin(), t.end(), [&](std::uint32_t v) {
               return std::abs(dot(n, surface.normal(v))) < kBent;
             });
    });
  });
}

/// How the surface scatters at a point. All normals are unit vectors on the point's side.
struct Scattering {
  Vec3 normal;               ///< shading normal, which a normal map may have turned
  Vec3 smooth;               ///< shading normal without the normal map
  std::optional<Bsdf> coat;  ///< the Bsdf if the Lambert lobe lies under a coat

  LitSurface lit(Vec3 geometric) const { return {geometric, smooth, normal, coat ? &*coat : nullptr}; }
};

/// Scattering of a flat surface without a coat.
Scattering plain(const IrradiancePoint& point) { return {point.normal, point.normal, {}}; }

/// The surface on which a point was placed. A ray from 4 offsets above the point to 4 offsets below finds it; empty if
/// the ray finds none. offset: distance of rays from surfaces, m.
std::optional<SurfacePoint> surface_under(const Tracer& tracer, const IrradiancePoint& point, float offset) {
  const float above = 4 * offset;
  Hit hit;
  if (!tracer.intersect({point.position + point.normal * above, -point.normal, 0, 2 * above, true}, hit)) return {};
  return tracer.surface_point(hit);
}

/// Scattering at a point; plain() if no ray finds the point's surface.
Scattering scattering_at(const Tracer& tracer, const IrradiancePoint& point, float offset) {
  std::optional<SurfacePoint> surface = surface_under(tracer, point, offset);
  if (!surface) return plain(point);
  Scattering scattering;
  scattering.smooth = face_forward(surface->normal, point.normal);
  const SurfaceMaterial material(tracer.frame(), *surface);  // applies the normal map to surface->normal
  scattering.normal = face_forward(surface->normal, point.normal);
  const bool on_front = dot(surface->normal_geometric, point.normal) > 0;
  const Bsdf bsdf(material, on_front, Frame(scattering.normal));
  if (bsdf.has_diffuse() && bsdf.has_specular()) scattering.coat = bsdf;
  return scattering;
}

/// Samples direct light at points.
struct DirectLight {
  const Tracer& tracer;
  const Lights& lights;
  int samples;
  float offset = Reach(tracer).offset();
  SolidAround around{tracer};
  bool looks = !lights.empty() && (any_coated(tracer.frame()) || any_bent(tracer.frame()));

  /// Scattering at a point; plain() without a ray if all surfaces of the scene are flat and have no coat.
  Scattering scattering(const IrradiancePoint& point) const {
    return looks ? scattering_at(tracer, point, offset) : plain(point);
  }
  /// Irradiance [W/m^2]: the mean over the light samples.
  Rgb at(const IrradiancePoint& point, const Scattering& scattering, const PathRandom& random) const {
    Rgbd sum{0.0};
    const Inside inside(around(point.position, point.normal, offset));
    for_samples(point, scattering, random, [&](const DirectSample& direct, const WayBits& bits) {
      Rgbd passed(transmittance(tracer, direct.shadow, bits));
      if (inside.any() && !direct.light.distant) [[unlikely]]
        passed *=
            Rgbd(inside.transmittance_over(tracer.frame().materials, length(direct.light.position - point.position)));
      sum += Rgbd(direct.irradiance) * passed;
    });
    return Rgb(sum / double(samples));
  }
  /// Draws `samples` stratified light samples. Calls each(sample, random bits for media on the shadow ray) for each
  /// sample that can light the point.
  template <class Each>
  void for_samples(const IrradiancePoint& point, const Scattering& scattering, const PathRandom& random,
                   const Each& each) const {
    if (lights.empty()) return;
    const SurfacePoint from = surface_of(point, offset);
    const Receiver at{from, point.normal, scattering.normal, scattering.coat ? &*scattering.coat : nullptr};
    for (std::uint32_t s = 0; s < std::uint32_t(samples); ++s) {
      const float u = (float(s) + random.get1(0, Purpose::light_choice, s)) / float(samples);
      DirectSample direct;
      if (sample_direct(lights, at, std::min(u, kOneMinusEpsilon), random.get2(0, Purpose::light_point, s), direct))
        each(direct, WayBits{random, s, way_shadow});
    }
  }
};

std::vector<std::uint32_t> all_of(std::span<const IrradiancePoint> points) {
  std::vector<std::uint32_t> all(points.size());
  std::iota(all.begin(), all.end(), 0u);
  return all;
}

/// Orders the points with the indices `which` by position, so that successive look-ups and rays find their data in the
/// processor's cache.
std::vector<std::uint32_t> in_space(const std::vector<IrradiancePoint>& points, std::span<const std::uint32_t> which) {
  std::vector<Vec3> positions;
  for (const std::uint32_t i : which) positions.push_back(points[i].position);
  std::vector<std::uint32_t> order = morton_order(positions);
  for (std::uint32_t& i : order) i = which[i];
  return order;
}

/// Box around all lights, in scene space; none if there are distant lights.
std::optional<Box3> box_of_lights(const SceneFrame& frame) {
  if (frame.environment) return std::nullopt;
  Box3 box;
  for (const PlacedLight& placed : frame.lights) {
    if (placed.light.distant()) return std::nullopt;
    const float r = placed.light.size.radius_m;
    const Vec3 reach{r, r, r};
    box.add(placed.position - reach);
    box.add(placed.position + reach);
  }
  for (const Surface& surface : frame.surfaces)
    if (frame.materials[surface.material].emissive())
      for (std::uint32_t v = 0; v < surface.primitive->positions.size(); ++v) box.add(surface.position(v));
  return box;
}

}  // namespace

PathRandom point_random(const PointOptions& options, std::uint32_t point) {
  return PathRandom(options.seed ^ 0x706f696e74ull, point);
}

PlacedPoints place_points(const SceneFrame& frame, const PointOptions& options) {
  const std::vector<AimSphere> region = region_of_points(frame, options.seen);
  std::vector<std::optional<Ground>> grounds(frame.surfaces.size());  // of surfaces that store light
  double standing = 0, moving = 0;
  for (std::size_t i = 0; i < grounds.size(); ++i) {
    if (!stores_light(frame, frame.surfaces[i])) continue;
    double& sum = i < frame.static_count ? standing : moving;
    for (const double area : std::span<double>(grounds[i].emplace(ground_of(frame.surfaces[i], region)).areas))
      sum += area;
  }
  const double whole = standing > 0 ? standing : moving;
  PlacedPoints placed;
  if (whole > 0) placed.spacing = float(std::sqrt(whole / std::max(1u, options.count)));
  const double area_per_point = double(placed.spacing) * double(placed.spacing);
  std::map<std::uint32_t, std::uint32_t> surfaces_of;  // by object
  for (std::size_t i = 0; i < grounds.size(); ++i) {
    const Surface& surface = frame.surfaces[i];
    const std::uint32_t rank = surfaces_of[surface.object]++;
    const double area = grounds[i] ? add_up(*grounds[i]) : 0;
    if (!(area > 0)) continue;
    const auto count = std::uint32_t(std::max(1.0, std::ceil(area / area_per_point)));
    for (const bool back : {false, true}) {
      const std::uint64_t key = PathRandom(options.seed, surface.object).bits(rank, Purpose::points, back);
      const auto points = spread({surface, *grounds[i], count, back}, key, [](Vec3) { return true; });
      placed.points.insert(placed.points.end(), points.begin(), points.end());
    }
  }
  return placed;
}

std::vector<PlacedSite> place_sites(const SceneFrame& frame, std::span<const std::uint32_t> objects,
                                    const AimSphere& around, double area, std::uint64_t seed,
                                    const std::function<bool(Vec3)>& wanted) {
  std::vector<PlacedSite> sites;
  for (std::size_t s = 0; s < frame.surfaces.size(); ++s) {
    const Surface& surface = frame.surfaces[s];
    if (!stores_light(frame, surface) || !std::binary_search(objects.begin(), objects.end(), surface.object)) continue;
    Ground ground = ground_of(surface, {&around, 1});
    const double whole = add_up(ground);
    if (!(whole > 0)) continue;
    const auto count = std::uint32_t(std::clamp(std::ceil(whole / area), 1.0, double(kMostSites)));
    for (const bool back : {false, true}) {
      const std::uint64_t key = PathRandom(seed, s).bits(0, Purpose::place, back);
      for (const IrradiancePoint& place : spread({surface, ground, count, back}, key, wanted))
        sites.push_back({place, float(whole / count)});
    }
  }
  return sites;
}

void estimate_points(const Tracer& tracer, const Lights& lights, const PhotonView& photons, Vec3d photon_shift,
                     const PointOptions& options, std::vector<IrradiancePoint>& points) {
  estimate_points(tracer, lights, {photons, photon_shift}, options, all_of(points), points);
}

void estimate_points(const Tracer& tracer, const Lights& lights, const ShiftedPhotons& shifted,
                     const PointOptions& options, std::span<const std::uint32_t> which,
                     std::vector<IrradiancePoint>& points) {
  const auto& [photons, photon_shift] = shifted;
  // Photons far from the points were not aimed and are far apart, so only photons in the region determine the radius.
  std::function<bool(Vec3)> where;
  if (const std::vector<AimSphere> region = region_of_points(tracer.frame(), options.seen); !region.empty())
    where = [region](Vec3 place) {
      return std::ranges::any_of(
          region, [&](const AimSphere& sphere) { return length(Vec3d(place) - sphere.centre) <= sphere.radius; });
    };
  const DensityOptions density{options.neighbours, options.max_radius, options.area_probes, where};
  const FootprintDensity caustic(tracer, photons, {density.neighbours, density.max_radius, 0},
                                 kind_bit(formats::PathKind::caustic), photon_shift);
  const PointDensity indirect(tracer, photons.photons, density, kind_bit(formats::PathKind::indirect), photon_shift);
  const DirectLight direct{tracer, lights, options.light_samples};
  const std::vector<std::uint32_t> order = in_space(points, which);
  parallel_each(order.size(), 256, [&](std::size_t i) {
    IrradiancePoint& point = points[order[i]];
    const PathRandom random = point_random(options, order[i]);
    const Scattering scattering = direct.scattering(point);
    point.direct = direct.at(point, scattering, random);
    const FootprintLight light = caustic.estimate(point.position, scattering.lit(point.normal));
    const PointDensity::Estimate rest = indirect.estimate(point, random);
    point.indirect = rest.irradiance;
    point.radius = rest.radius;
    point.caustic = light.irradiance;
    point.noise = light.noise + rest.noise;
  });
}

void estimate_caustic(const Tracer& tracer, const FootprintDensity& density, std::vector<IrradiancePoint>& points) {
  const float offset = Reach(tracer).offset();
  parallel_each(points.size(), 256, [&](std::size_t i) {
    IrradiancePoint& point = points[i];
    const Scattering scattering = density.directed() ? scattering_at(tracer, point, offset) : plain(point);
    point.caustic = density.estimate(point.position, scattering.lit(point.normal)).irradiance;
  });
}

std::size_t update_direct(const Tracer& tracer, const Lights& lights, const MoverWatch* watch,
                          const PointOptions& options, std::vector<IrradiancePoint>& points) {
  if (lights.empty()) return 0;
  const DirectLight direct{tracer, lights, options.light_samples};
  const std::vector<std::uint32_t> order = in_space(points, all_of(points));
  const std::optional<Box3> box = box_of_lights(tracer.frame());
  return parallel_sum<std::size_t>(order.size(), 256, [&](std::size_t i, std::size_t& sampled) {
    IrradiancePoint& point = points[order[i]];
    if (watch && box && !watch->between(point.position, *box)) return;
    const PathRandom random = point_random(options, order[i]);
    const Scattering scattering = direct.scattering(point);
    bool touched = !watch;
    if (watch)
      direct.for_samples(point, scattering, random, [&](const DirectSample& sample, const WayBits&) {
        touched = touched || watch->touching(sample.shadow, 1) != 0;
      });
    if (!touched) return;
    point.direct = direct.at(point, scattering, random);
    ++sampled;
  });
}

ClearanceTest point_clearance(const Tracer& tracer) {
  return [reach = Reach(tracer)](Vec3 position, Vec3 normal, float far) {
    return reach.clearance(position, normal, normal, far);
  };
}

}  // namespace tempolux
