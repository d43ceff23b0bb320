#include "lib/material/smooth_material.h"

#include "lib/material/bsdf.h"

namespace tempolux {

std::uint32_t first_smooth_material(const SceneFrame& frame) {
  std::uint32_t first = kNone;
  for (const Surface& surface : frame.surfaces) {
    const Material& material = frame.materials[surface.material];
    if (surface.material >= first || material.unlit || !surface.primitive || surface.primitive->triangles.empty())
      continue;
    const Bsdf bsdf(material);
    if (bsdf.has_specular() && bsdf.specular_is_delta()) first = surface.material;
  }
  return first;
}

}  // namespace tempolux
