#include "lib/render/see_photons.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "lib/core/frame.h"
#include "lib/core/parallel.h"
#include "lib/core/sampling.h"
#include "lib/material/bsdf.h"
#include "lib/material/surface_material.h"
#include "lib/gather/footprint_density.h"
#include "lib/render/shading.h"

namespace tempolux {
namespace {

constexpr int kColumns = 32, kRows = 18;  ///< parts of the picture over which the mean square is taken
/// Share of the ray's length: if the hit of a camera ray is farther from the photon than this, the camera does not
/// see the photon.
constexpr float kSame = 1e-3f;

/// Share of the picture that 1 m^2 of the plane through `point` (normal: unit) covers; 0 if it cannot be computed.
double picture_share(const CameraView& view, Vec3 point, Vec3 normal, const std::array<double, 2>& at) {
  const Frame frame(normal);
  const float step = view.pixel_size(float(view.depth(point)));
  const auto right = view.project(point + frame.tangent * step), up = view.project(point + frame.bitangent * step);
  if (!right || !up) return 0;
  const double area = ((*right)[0] - at[0]) * ((*up)[1] - at[1]) - ((*right)[1] - at[1]) * ((*up)[0] - at[0]);
  return std::abs(area) / (double(step) * double(step) * view.width() * view.height());
}

/// A photon's contribution to the mean radiance of the picture, and its position in the picture.
struct SeenFlux {
  double radiance = 0;
  std::size_t cell = 0;
};
/// Contribution of photon i: flux x rho / pi x picture_share if the camera sees it, else 0. Nothing is blurred, so the
/// sum over photons is unbiased.
SeenFlux seen_flux(const RenderScene& scene, const CameraView& view, const PhotonView& photons, std::size_t i) {
  const formats::Photon& photon = photons.photons[i];
  const Vec3 point{photon.position[0], photon.position[1], photon.position[2]};
  const auto n = formats::decode_normal(photon.normal);
  const Vec3 normal{n[0], n[1], n[2]};
  const auto at = view.project(point);
  if (!at || !((*at)[0] >= 0 && (*at)[0] < view.width() && (*at)[1] >= 0 && (*at)[1] < view.height())) return {};
  const Ray ray = view.ray(float((*at)[0]), float((*at)[1]));
  if (!(dot(ray.direction, normal) < 0)) return {};
  Hit hit;
  scene.tracer.intersect(ray, hit);
  if (hit.surface == kNone) return {};
  SurfacePoint surface = scene.tracer.surface_point(hit);
  if (length(surface.position - point) > kSame * hit.t) return {};
  const Vec3 smooth = surface.normal;
  const SurfaceMaterial material(scene.frame(), surface, view.pixel_size(hit.t));
  const ShadingPoint shading(surface, -ray.direction, material);
  const Rgb albedo = shading.bsdf.diffuse_albedo();
  Rgb flux(photon.flux[0], photon.flux[1], photon.flux[2]);
  if (photons.directed()) {
    const auto w = formats::decode_normal(photons.directions[i]);
    const Vec3 wi{w[0], w[1], w[2]};
    flux *=
        received_share(wi, normal, {shading.normal_geometric, shading.facing(smooth), shading.normal, &shading.bsdf});
  }
  const auto cell = [](double x, int size, int cells) { return std::size_t(std::min(cells - 1.0, x / size * cells)); };
  return {double(channel_mean(albedo * flux)) / kPi * picture_share(view, point, normal, *at),
          cell((*at)[1], view.height(), kRows) * kColumns + cell((*at)[0], view.width(), kColumns)};
}

}  // namespace

SeenPhotons see_photons(const RenderScene& scene, const CameraView& view, const PhotonView& photons,
                        formats::PathKind kind) {
  std::vector<SeenFlux> seen(photons.photons.size());
  parallel_chunks(photons.photons.size(), 64, [&](std::size_t first, std::size_t last) {
    for (std::size_t i = first; i < last; ++i)
      if (photons.photons[i].kind == kind) seen[i] = seen_flux(scene, view, photons, i);
  });
  SeenPhotons pilot;
  std::vector<double> cells(kRows * kColumns, 0.0);
  double squares = 0;
  for (const SeenFlux& one : seen) {
    pilot.mean += one.radiance;
    pilot.photons += one.radiance > 0;
    squares += one.radiance * one.radiance;
    cells[one.cell] += one.radiance;
  }
  pilot.mean_error = std::sqrt(squares);
  for (const double cell : cells) pilot.square += cell * cell * double(cells.size());
  return pilot;
}

}  // namespace tempolux
