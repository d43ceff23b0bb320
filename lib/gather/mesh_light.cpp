#include "lib/gather/mesh_light.h"


namespace tempolux {
namespace {

/// One number for each side: 32 bits of surface, 31 of triangle, one of side.
std::uint64_t key(std::uint32_t surface, std::uint32_t triangle, std::uint32_t side) {
  return std::uint64_t(surface) << 32 | std::uint64_t(triangle & 0x7fffffffu) << 1 | side;
}

}  // namespace

MeshLight::MeshLight(formats::MeshirradFile file) : file_(std::move(file)) {
  for (std::size_t i = 0; i < file_.elements.size();) {
    const formats::MeshElement& e = file_.elements[i];
    sides_.emplace(key(e.surface, e.triangle, e.side), std::uint32_t(i));
    i += std::size_t(e.cuts) * e.cuts;
  }
}

Rgb MeshLight::irradiance(const SurfacePoint& hit, Vec3 geometric) const {
  const auto found = sides_.find(key(hit.surface, hit.triangle, dot(hit.normal_geometric, geometric) < 0));
  if (found == sides_.end()) return Rgb(0.0f);
  const formats::MeshElement* const first = &file_.elements[found->second];
  const auto& e = first[formats::mesh_cell(first->cuts, hit.u, hit.v)].irradiance;
  return {e[0], e[1], e[2]};
}

}  // namespace tempolux
