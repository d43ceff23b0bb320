#include "lib/material/smooth_material.h"

#include "lib/material/bsdf.h"

namespace tempolux {
namespace {

/// A lobe of GGX width alpha = roughness^2 sends light of a lamp without extent into about 4 pi alpha^2 sr, which a ray
/// from a matte surface meets with a chance of at most 4 alpha^2: below .07 1 in 10^4, so that of 100 samples of a
/// pixel none does, and one that does is a white dot.
constexpr float kSharpRoughness = 0.07f;

}  // namespace

std::uint32_t first_smooth_material(const SceneFrame& frame) {
  std::uint32_t first = kNone;
  for (const Surface& surface : frame.surfaces) {
    const Material& material = frame.materials[surface.material];
    if (surface.material >= first || material.unlit || !surface.primitive || surface.primitive->triangles.empty())
      continue;
    const Bsdf bsdf(material);
    if (bsdf.has_specular() && (bsdf.specular_is_delta() || material.roughness < kSharpRoughness))
      first = surface.material;
  }
  return first;
}

}  // namespace tempolux
