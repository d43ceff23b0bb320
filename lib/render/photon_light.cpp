#include "lib/render/photon_light.h"

#include <vector>

namespace tempolux {
namespace {

PhotonIndex index_of_kind(std::span<const formats::Photon> photons, formats::PathKind kind, Vec3d shift) {
  std::vector<formats::Photon> chosen;
  for (const formats::Photon& photon : photons) {
    if (photon.kind != kind) continue;
    chosen.push_back(photon);
    auto& p = chosen.back().position;
    if (!(shift == Vec3d{}))
      p = {float(double(p[0]) + shift.x), float(double(p[1]) + shift.y), float(double(p[2]) + shift.z)};
  }
  return PhotonIndex(chosen);
}

}  // namespace

PhotonLight::PhotonLight(std::span<const formats::Photon> photons, Vec3d photon_shift, const Box3& bounds,
                         const PhotonLightOptions& options)
    : caustic_(index_of_kind(photons, formats::PathKind::caustic, photon_shift)),
      indirect_(options.caustic_only ? PhotonIndex()
                                     : index_of_kind(photons, formats::PathKind::indirect, photon_shift)) {
  options_.neighbours = options.neighbours;
  options_.max_radius = options.max_radius > 0 ? options.max_radius : 0.05f * bounds.diagonal();
}

Rgb PhotonLight::estimate(const PhotonIndex& index, Vec3 position, Vec3 normal) const {
  if (index.size() == 0) return Rgb(0.0f);
  thread_local NeighbourList scratch;
  return Rgb(estimate_irradiance(index, position, normal, options_, scratch).irradiance);
}

DiffuseLight::Irradiance PhotonLight::at(const SurfacePoint& surface, Vec3 geometric, Vec3) const {
  return {estimate(caustic_, surface.position, geometric), estimate(indirect_, surface.position, geometric)};
}

}  // namespace tempolux
