#include "lib/material/surface_material.h"

#include "lib/material/bsdf.h"
#include "lib/scene/texture_lookup.h"

namespace tempolux {

void SurfaceMaterial::read_textures(const SceneFrame& frame, SurfacePoint& point, float width) {
  const Material& material = frame.materials[point.material];
  const MaterialTextures& textures = *material.textures;
  const TextureSpot spot(frame, point.surface, point.triangle, point.u, point.v, width);
  MaterialValues& values = textured_.emplace(material);
  if (textures.base_color) {
    const Rgba colour = spot.read(textures.base_color, base_color_transfer(material));
    values.base_color *= Rgb{colour[0], colour[1], colour[2]};
  }
  if (textures.vertex_colors) {
    const Rgba colour = spot.vertex_color();
    values.base_color *= Rgb{colour[0], colour[1], colour[2]};
  }
  if (textures.metallic_roughness) {
    const Rgba share = spot.read(textures.metallic_roughness, TextureTransfer::linear);
    values.roughness *= share[1];
    values.metallic *= share[2];
  }
  if (textures.transmission && values.transmission > 0)
    values.transmission *= spot.read(textures.transmission, TextureTransfer::linear)[0];
  if (textures.normal)
    point.normal = spot.bend(textures.normal, textures.normal_scale, point.normal, point.normal_geometric);
  values_ = &values;
}

bool may_have_lambert(const Material& material) {
  MaterialValues values = material;
  if (material.textures && material.textures->metallic_roughness) values.metallic = 0;
  if (material.textures && material.textures->transmission) values.transmission = 0;
  return Bsdf(values).has_lambert();
}

Lobes lobes_of(const Material& material) {
  const Bsdf bsdf(material);
  return {bsdf.has_diffuse() || (material.textures && may_have_lambert(material)), bsdf.has_specular()};
}

Lobes lobes_of(const SceneFrame& frame) {
  std::vector<bool> used(frame.materials.size());
  for (const Surface& surface : frame.surfaces)
    if (surface.primitive && !surface.primitive->triangles.empty()) used[surface.material] = true;
  Lobes lobes;
  for (std::size_t m = 0; m < used.size(); ++m)
    if (used[m]) lobes |= lobes_of(frame.materials[m]);
  return lobes;
}

}  // namespace tempolux
