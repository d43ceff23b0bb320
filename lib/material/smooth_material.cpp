#include "lib/material/smooth_material.h"

#include <algorithm>

#include "lib/material/bsdf.h"

namespace tempolux {
namespace {

/// A lobe of GGX width alpha = roughness^2 reflects the light of a lamp without extent into about 4 pi alpha^2 sr. A
/// ray from a matte surface meets this solid angle with a probability of at most 4 alpha^2, which is 1 in 10^4 at this
/// roughness. So 100 samples of a pixel usually miss the light, and a sample that meets it makes a white dot.
constexpr float kSharpRoughness = 0.07f;

/// The least roughness of the lobes.
float sharpest(const MaterialValues& m) {
  return m.clearcoat > 0 ? std::min(m.roughness, m.clearcoat_roughness) : m.roughness;
}

}  // namespace

std::uint32_t first_smooth_material(const SceneFrame& frame, bool panes,
                                    const std::function<bool(std::uint32_t)>& plates) {
  std::uint32_t first = kNone;
  for (std::uint32_t s = 0; s < frame.surfaces.size(); ++s) {
    const Surface& surface = frame.surfaces[s];
    const Material& material = frame.materials[surface.material];
    if (surface.material >= first || material.unlit || !surface.primitive || surface.primitive->triangles.empty())
      continue;
    if (plates && plates(s)) continue;
    const Bsdf bsdf(material);
    if (!panes && max_component(bsdf.passed_straight(1)) > 0) continue;
    if (bsdf.has_specular() && (bsdf.specular_is_delta() || sharpest(material) < kSharpRoughness))
      first = surface.material;
  }
  return first;
}

}  // namespace tempolux
