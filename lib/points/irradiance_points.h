// lib/points/irradiance_points.h -- places irradiance points on the surfaces and estimates their light.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "formats/photons/photons.h"
#include "lib/points/footprint_density.h"
#include "lib/points/point_density.h"
#include "lib/points/point_region.h"
#include "lib/irradcache/points.h"
#include "lib/light/lights.h"
#include "lib/trace/mover_watch.h"
#include "lib/trace/trace.h"

namespace tempolux {

struct PointOptions {
  std::uint64_t seed = 0;
  /// Number of points on the front sides of all static surfaces together (of all surfaces if none is static). The back
  /// sides get the same number. Movers get the same number per area, and every surface gets at least one point.
  std::uint32_t count = 20000;
  /// Spheres around what cameras see, in scene space: points lie only in these. Empty: points lie on all surfaces.
  std::vector<AimSphere> seen = {};
  int neighbours = 50;    ///< k of the density estimates
  float max_radius = 0;   ///< m; 0: from the photons (FootprintOptions, DensityOptions)
  int light_samples = 4;  ///< shadow rays per point for direct light
  int area_probes = 32;   ///< DensityOptions::area_probes
};

struct PlacedPoints {
  std::vector<IrradiancePoint> points;
  /// m, mean distance of neighbours: the square root of the area per point; 1 if no surface stores light
  float spacing = 1;
};

/// Places points uniformly by area on both sides of every surface with a Lambert lobe. Their irradiance is not yet
/// estimated. If options.seen has spheres, only the parts of surfaces inside chosen spheres (spheres_with_points) get
/// points. The points of a surface depend only on that surface, the seed, the chosen spheres and the spacing, and the
/// spacing depends on the area of static surfaces. Points on static surfaces come first: they have the same positions
/// and indices in all frames of a segment. Points on movers move with their triangles.
PlacedPoints place_points(const SceneFrame& frame, const PointOptions& options);

/// A place on one side of a surface, and the area that it represents [m^2].
struct PlacedSite {
  IrradiancePoint place;  ///< position, normal, object
  float area = 0;
};

/// Places that are uniform by area on both sides of the surfaces that have a Lambert lobe and belong to one of
/// `objects` (id.object, ascending). The places lie inside the sphere `around` or slightly outside (pieces_in). Each
/// place represents at most `area` [m^2]; the areas of all places on a side add up to the area of that part of the
/// surface. Returns only the places that `wanted` accepts; `wanted` is called from many threads.
std::vector<PlacedSite> place_sites(const SceneFrame& frame, std::span<const std::uint32_t> objects,
                                    const AimSphere& around, double area, std::uint64_t seed,
                                    const std::function<bool(Vec3)>& wanted);

/// A surface point from which rays can start, at the place of an irradiance point. Rays start `offset` [m] above the
/// surface. The shading normal and the geometric normal are both the irradiance point's normal.
inline SurfacePoint surface_of(const IrradiancePoint& point, float offset) {
  SurfacePoint surface{};
  surface.position = point.position;
  surface.normal = surface.normal_geometric = point.normal;
  surface.offset = offset;
  return surface;
}

/// Estimates the irradiance of all points.
/// - Direct light: by light sampling with stratified shadow rays and the shading normal at the point, times
/// Bsdf::arrival_weight under a coat.
/// - Caustic light: by FootprintDensity, with the shading normal if the photons store directions.
/// - Indirect light: by PointDensity.
/// Normal maps are read at their finest level, because points represent the hits of gather rays. photon_shift [m] is
/// added to the photons' positions and brings them into scene space. Same results for any number of threads.
void estimate_points(const Tracer& tracer, const Lights& lights, const PhotonView& photons, Vec3d photon_shift,
                     const PointOptions& options, std::vector<IrradiancePoint>& points);

/// Photons whose positions lie in scene space after `shift` [m] is added.
struct ShiftedPhotons {
  PhotonView photons;
  Vec3d shift{};
};
/// Estimates only the points with these indices, with the same results as if all points were estimated.
void estimate_points(const Tracer& tracer, const Lights& lights, const ShiftedPhotons& photons,
                     const PointOptions& options, std::span<const std::uint32_t> which,
                     std::vector<IrradiancePoint>& points);
/// Estimates the caustic light of all points as estimate_points() does, with this density.
void estimate_caustic(const Tracer& tracer, const FootprintDensity& density, std::vector<IrradiancePoint>& points);
/// Samples direct light again, as estimate_points() does, at points with a shadow ray that meets a box of `watch`, or
/// at all points if `watch` is nullptr. The other points keep their light, because their shadow rays meet the same
/// surfaces as before. Returns the number of points sampled.
std::size_t update_direct(const Tracer& tracer, const Lights& lights, const MoverWatch* watch,
                          const PointOptions& options, std::vector<IrradiancePoint>& points);
/// Random numbers of a point, keyed by its index.
PathRandom point_random(const PointOptions& options, std::uint32_t point);

/// The clearance test for PointLookup on this scene (Reach::clearance); the tracer must outlive it.
ClearanceTest point_clearance(const Tracer& tracer);

}  // namespace tempolux
