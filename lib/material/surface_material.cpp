#include "lib/material/surface_material.h"

#include <cmath>

#include "lib/material/bsdf.h"
#include "lib/material/dispersion.h"
#include "lib/scene/texture_lookup.h"

namespace tempolux {

namespace {

Rgb colour_of(const Rgba& texel) { return {texel[0], texel[1], texel[2]}; }

/// The coat's strength, roughness and normal. `smooth`: the shading normal without a normal map.
void read_coat(const MaterialTextures& textures, const TextureSpot& spot, Vec3 smooth, const SurfacePoint& point,
               MaterialValues& values) {
  if (textures.clearcoat) values.clearcoat *= spot.read(textures.clearcoat, TextureTransfer::linear)[0];
  if (textures.clearcoat_roughness)
    values.clearcoat_roughness *= spot.read(textures.clearcoat_roughness, TextureTransfer::linear)[1];
  Vec3 normal = smooth;
  if (textures.clearcoat_normal)
    normal = spot.bend(textures.clearcoat_normal, textures.clearcoat_normal_scale, smooth, point.normal_geometric);
  if (normal != point.normal) values.axes.coat_normal = normal;
}

/// The share and the thickness of the film.
void read_film(const MaterialTextures& textures, const TextureSpot& spot, MaterialValues& values) {
  if (textures.iridescence) values.iridescence *= spot.read(textures.iridescence, TextureTransfer::linear)[0];
  if (textures.iridescence_thickness) {
    const float thin = values.iridescence_thickness_minimum;
    float& thickness = values.iridescence_thickness_maximum;
    thickness = thin + (thickness - thin) * spot.read(textures.iridescence_thickness, TextureTransfer::linear)[1];
  }
}

void read_sheen(const MaterialTextures& textures, const TextureSpot& spot, MaterialValues& values) {
  if (textures.sheen_color) values.sheen_color *= colour_of(spot.read(textures.sheen_color, TextureTransfer::srgb));
  if (textures.sheen_roughness)
    values.sheen_roughness *= spot.read(textures.sheen_roughness, TextureTransfer::linear)[3];
}

/// Strength and direction of the anisotropy. Without tangents the grain stays zero, and the reflection is round.
void read_grain(const MaterialTextures& textures, const TextureSpot& spot, Vec3 normal, MaterialValues& values) {
  Vec2 along{1, 0};
  if (textures.anisotropy) {
    const Rgba texel = spot.read(textures.anisotropy, TextureTransfer::linear);
    along = {2 * texel[0] - 1, 2 * texel[1] - 1};
    values.anisotropy *= texel[2];
  }
  Vec3 right, up;
  if (!(values.anisotropy > 0) || !spot.axes(textures.anisotropy, normal, right, up)) return;
  const float c = std::cos(values.anisotropy_rotation), s = std::sin(values.anisotropy_rotation);
  values.axes.grain = normalize(right * (c * along.x - s * along.y) + up * (s * along.x + c * along.y));
}

}  // namespace

void SurfaceMaterial::read_textures(const SceneFrame& frame, SurfacePoint& point, float width) {
  const Material& material = frame.materials[point.material];
  const MaterialTextures& textures = *material.textures;
  const TextureSpot spot(frame, point.surface, point.triangle, point.u, point.v, width);
  MaterialValues& values = textured_.emplace(material);
  if (textures.base_color) {
    const Rgba colour = spot.read(textures.base_color, base_color_transfer(material));
    values.base_color *= colour_of(colour);
  }
  if (textures.vertex_colors) {
    const Rgba colour = spot.vertex_color();
    values.base_color *= colour_of(colour);
  }
  if (textures.metallic_roughness) {
    const Rgba share = spot.read(textures.metallic_roughness, TextureTransfer::linear);
    values.roughness *= share[1];
    values.metallic *= share[2];
  }
  if (textures.transmission && values.transmission > 0)
    values.transmission *= spot.read(textures.transmission, TextureTransfer::linear)[0];
  if (textures.specular) values.specular *= spot.read(textures.specular, TextureTransfer::linear)[3];
  if (textures.specular_color)
    values.specular_color *= colour_of(spot.read(textures.specular_color, TextureTransfer::srgb));
  const Vec3 smooth = point.normal;
  if (textures.normal) point.normal = spot.bend(textures.normal, textures.normal_scale, smooth, point.normal_geometric);
  if (values.clearcoat > 0) read_coat(textures, spot, smooth, point, values);
  if (values.iridescence > 0) read_film(textures, spot, values);
  if (max_component(values.sheen_color) > 0) read_sheen(textures, spot, values);
  if (textures.diffuse_transmission)
    values.diffuse_transmission *= spot.read(textures.diffuse_transmission, TextureTransfer::linear)[3];
  if (textures.diffuse_transmission_color)
    values.diffuse_transmission_color *=
        colour_of(spot.read(textures.diffuse_transmission_color, TextureTransfer::srgb));
  if (values.anisotropy > 0) read_grain(textures, spot, point.normal, values);
  values_ = &values;
}

void SurfaceMaterial::disperse(float wavelength_nm) {
  const float index = index_at(*values_, wavelength_nm);
  if (index == values_->ior) return;
  MaterialValues& values = textured_ ? *textured_ : textured_.emplace(*values_);
  values.ior = index;
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
