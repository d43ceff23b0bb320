// lib/gather/irradiance_points.h -- spread irradiance points over the surfaces and estimate them.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "formats/photons/photons.h"
#include "lib/gather/footprint_density.h"
#include "lib/gather/point_density.h"
#include "lib/gather/point_region.h"
#include "lib/irradcache/points.h"
#include "lib/light/lights.h"
#include "lib/trace/mover_watch.h"
#include "lib/trace/trace.h"

namespace tempolux {

struct PointOptions {
  std::uint64_t seed = 0;
  std::uint32_t count = 20000;  ///< per side of all static surfaces together (if there are none, of all); what moves
                                ///< gets as many per area, and every surface at least one
  std::vector<AimSphere> seen = {};  ///< scene space; what cameras see: points lie there alone. None: on all surfaces
  int neighbours = 50;               ///< k of the density estimates
  float max_radius = 0;              ///< m; 0: from the photons' spacing
  int light_samples = 4;             ///< shadow rays per point for direct light
  int area_probes = 32;              ///< that must arrive in a disc cut by walls or edges
};

struct PlacedPoints {
  std::vector<IrradiancePoint> points;
  /// m, mean distance of neighbours: square root of the area each stands for; 1 where no surface stores light.
  float spacing = 1;
};

/// Points uniform by area on both sides of every surface that has a Lambert lobe, without irradiance yet; with
/// options.seen on what lies in those spheres (spheres_with_points) alone. The points of a surface depend on that
/// surface, the seed, the spheres and the spacing alone, and the spacing on the static area. Those of static surfaces
/// come first: they have the same places and numbers at every frame of a segment; those of moving ones ride on their
/// triangles.
PlacedPoints place_points(const SceneFrame& frame, const PointOptions& options);

/// A place on one side of a surface, and the area that it stands for [m^2].
struct PlacedSite {
  IrradiancePoint place;  ///< position, normal, object
  float area = 0;
};

/// Places uniform by area on both sides of the surfaces of these objects (id.object, ascending) that have a Lambert
/// lobe, as far as they lie in the sphere `around` and a little beyond (pieces_in), each for `area` [m^2] or a little
/// less: areas of a side add up to the surface's. Only those that `wanted` takes, nothing outside of the sphere; it is
/// asked from many threads.
std::vector<PlacedSite> place_sites(const SceneFrame& frame, std::span<const std::uint32_t> objects,
                                    const AimSphere& around, double area, std::uint64_t seed,
                                    const std::function<bool(Vec3)>& wanted);

/// Fills in the irradiance of all points:
/// - direct by light sampling, stratified shadow rays, by the shading normal at the point, under a coat times
/// Bsdf::arrival_weight;
/// - caustic and indirect by the density of the photons of that kind (FootprintDensity, PointDensity), caustic likewise
/// by the normal at
///   the point if photons have directions.
/// Normal maps count by their finest level: points stand for what rays of gathering meet (RayCone).
/// photon_shift is added to the photons' positions: scene space minus theirs. Same results for any number of
/// threads.
void estimate_points(const Tracer& tracer, const Lights& lights, const PhotonView& photons, Vec3d photon_shift,
                     const PointOptions& options, std::vector<IrradiancePoint>& points);

/// The same for the points of these numbers alone; each is what it would be among all.
void estimate_points(const Tracer& tracer, const Lights& lights, const PhotonView& photons, Vec3d photon_shift,
                     const PointOptions& options, std::span<const std::uint32_t> which,
                     std::vector<IrradiancePoint>& points);
/// Caustic light of all points by this density, as estimate_points has it.
void estimate_caustic(const Tracer& tracer, const FootprintDensity& density, std::vector<IrradiancePoint>& points);
/// Samples direct light anew, as estimate_points does, where one of a point's shadow rays meets a box of `watch`;
/// nullptr: at all points. The others keep what they have: the same samples meet the same there. Returns how many were
/// sampled.
std::size_t update_direct(const Tracer& tracer, const Lights& lights, const MoverWatch* watch,
                          const PointOptions& options, std::vector<IrradiancePoint>& points);
/// Random numbers of a point, by its number.
PathRandom point_random(const PointOptions& options, std::uint32_t point);

/// What PointLookup asks for, on this scene (Reach::clearance); the tracer must outlive it.
ClearanceTest point_clearance(const Tracer& tracer);

}  // namespace tempolux
