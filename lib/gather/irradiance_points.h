// lib/gather/irradiance_points.h -- spread irradiance points over the surfaces and estimate them.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "formats/photons/photons.h"
#include "lib/irradcache/points.h"
#include "lib/light/lights.h"
#include "lib/trace/trace.h"

namespace tempolux {

struct PointOptions {
  std::uint64_t seed = 0;
  std::uint32_t count = 20000;      ///< per side of all surfaces together; every surface gets at least one
  int neighbours = 50;              ///< k of the density estimates
  float max_radius = 0;             ///< m; 0: a twentieth of the scene's diagonal
  int light_samples = 4;            ///< shadow rays per point for direct light
  int area_probes = 16;             ///< per disc; where one fails, four times as many
};

/// Mean distance of neighbouring points, m: square root of the area each stands for.
float point_spacing(const SceneFrame& frame, const PointOptions& options);

/// Points uniform by area on both sides of every surface that has a Lambert lobe, without irradiance yet. The
/// points of a surface depend on that surface, the seed and the spacing alone: those of static surfaces are
/// the same at every frame of a segment, those of moving ones ride on their triangles.
std::vector<IrradiancePoint> place_points(const SceneFrame& frame, const PointOptions& options);

/// Fills in the irradiance of all points:
/// - direct by light sampling, stratified shadow rays;
/// - caustic and indirect by the k nearest photons, E = sum of flux over the k-1 nearest that can be seen from
///   the point / area of the surface that can be reached inside their disc.
/// The area is probed: from the point across the tangent plane (nothing may stand in between), then down along
/// the normal (a surface that stores photons must be there, within the search's ellipsoid). Where every probe
/// arrives the disc is whole and no photon is tested; else each photon's own line of sight is. Clipping the
/// area alone gains light at thin walls, dropping photons alone loses it in corners (prototype.md 7).
void estimate_points(const Tracer& tracer, const Lights& lights, std::span<const formats::Photon> photons,
                     Vec3d photon_shift, const PointOptions& options, std::vector<IrradiancePoint>& points);

}  // namespace tempolux
