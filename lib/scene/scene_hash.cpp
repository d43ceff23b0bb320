// lib/scene/scene_hash.cpp -- computes the content hashes.
#include "lib/scene/scene_hash.h"

#include <map>

#include "formats/hash.h"
#include "lib/image/texture_images.h"
#include "lib/scene/camera_properties.h"
#include "lib/scene/material_properties.h"
#include "lib/scene/texture_lookup.h"

namespace tempolux {
namespace {

/// Number of each material by first use in node order; kNone: not used.
std::vector<std::uint32_t> material_numbers(const Scene& scene, LeftOut left_out) {
  std::vector<std::uint32_t> numbers(scene.materials.size(), kNone);
  std::uint32_t next = 0;
  for (std::size_t n = 0; n < scene.nodes.size(); ++n) {
    const Node& node = scene.nodes[n];
    if (node.mesh < 0 || (n < left_out.size() && left_out[n])) continue;
    for (const Primitive& primitive : scene.meshes[std::size_t(node.mesh)].primitives)
      if (numbers[primitive.material] == kNone) numbers[primitive.material] = next++;
  }
  return numbers;
}

template <class T>
void add_values(Hasher& hasher, const T& values) {
  using Value = std::remove_cvref_t<decltype(values[0])>;
  hasher.add_array(std::span<const Value>(values.data(), values.size()));
}

void add_shape(Hasher& hasher, const Surface& surface) {
  hasher.add(surface.object);
  hasher.add(std::uint32_t(surface.flipped));
  add_values(hasher, surface.positions);
  add_values(hasher, surface.primitive->triangles);
}

/// Adds vertex colours and tangents if the primitive has any.
void add_colors_and_tangents(Hasher& hasher, const Primitive& primitive) {
  if (!primitive.colors.empty()) {
    hasher.add(std::string_view("vertex colours"));
    add_values(hasher, primitive.colors);
  }
  if (primitive.tangents.empty()) return;
  add_values(hasher, primitive.tangents);
  add_values(hasher, primitive.tangent_sides);
}

/// Digest of the data that the instances of a primitive share.
std::string shared_digest(const Primitive& primitive) {
  Hasher hasher;
  add_values(hasher, primitive.positions);
  add_values(hasher, primitive.triangles);
  add_values(hasher, primitive.normals);
  add_values(hasher, primitive.uvs);
  if (!primitive.uvs1.empty()) add_values(hasher, primitive.uvs1);
  add_colors_and_tangents(hasher, primitive);
  return hasher.hex();
}

/// Adds an instance: its transform and its primitive's digest, which is computed once.
void add_instance(Hasher& hasher, const Surface& surface, std::map<const Primitive*, std::string>& digests) {
  std::string& digest = digests[surface.primitive];
  if (digest.empty()) digest = shared_digest(*surface.primitive);
  hasher.add(surface.object);
  hasher.add(surface.scene_from_node);
  hasher.add(std::string_view(digest));
}

/// Adds a texture: its image's bytes and its transform. Adds nothing for a material without the texture.
void add_texture(Hasher& hasher, const Scene& scene, const char* name, const Texture& texture) {
  if (!texture) return;
  hasher.add(std::string_view(name));
  hasher.add(std::string_view(scene.images->encoded(texture.image).digest));
  for (const float number : texture.transform) hasher.add(number);
  for (const std::uint32_t number :
       {texture.uv_set, std::uint32_t(texture.wrap_u), std::uint32_t(texture.wrap_v), std::uint32_t(texture.nearest)})
    hasher.add(number);
}

/// Adds all properties that scatter light. Emission is in lights_hash().
void add_material(Hasher& hasher, const Scene& scene, const Material& material) {
  static const Material kDefault;
  for (const MaterialProperty& property : material_properties()) {
    if (property.changes_emission() || property.role == PropertyRole::alpha_cutoff) continue;
    if (property.hashed_if_set) {
      const auto same = [&](auto member) { return material.*member == kDefault.*member; };
      if (std::visit(same, property.member)) continue;
      hasher.add(std::string_view(property.name));
    }
    if (const auto* number = std::get_if<float Material::*>(&property.member)) hasher.add(material.**number);
    else if (const auto* colour = std::get_if<Rgb Material::*>(&property.member)) hasher.add(material.**colour);
    else hasher.add(std::uint32_t(material.*std::get<bool Material::*>(property.member)));
  }
  hasher.add(std::uint32_t(material.alpha_mode));
  if (material.alpha_mode != Material::Alpha::opaque) hasher.add(material.alpha);
  if (material.alpha_mode == Material::Alpha::mask) hasher.add(material.alpha_cutoff);
  if (!material.textures) return;
  for (const MaterialTexture& texture : material_textures())
    if (texture.member != &MaterialTextures::emission)
      add_texture(hasher, scene, texture.name, (*material.textures).*texture.member);
  if (material.textures->normal) hasher.add(material.textures->normal_scale);
  if (material.textures->clearcoat_normal) hasher.add(material.textures->clearcoat_normal_scale);
}

/// Adds a member of a camera, unless it has no effect.
void add_property(Hasher& hasher, const Camera& camera, const CameraProperty& property) {
  if (property.role == CameraRole::lens && !camera.has_lens()) return;
  if (property.role == CameraRole::perspective && camera.kind != Camera::Kind::perspective) return;
  if (property.role == CameraRole::orthographic && camera.kind != Camera::Kind::orthographic) return;
  std::visit(
      [&](auto member) {
        const auto& value = camera.*member;
        using Value = std::remove_cvref_t<decltype(value)>;
        if constexpr (std::is_enum_v<Value>) hasher.add(std::uint32_t(value));
        else if constexpr (std::is_same_v<Value, double>) hasher.add(value);
        else if (value != Value{})
          for (const double number : value) hasher.add(number);
      },
      property.member);
}

}  // namespace

std::string geometry_hash(const Scene& scene, Vec3d origin, std::span<const Surface> surfaces, LeftOut left_out) {
  const std::vector<std::uint32_t> numbers = material_numbers(scene, left_out);
  Hasher hasher;
  hasher.add(std::string_view("geometry 1"));
  std::map<const Primitive*, std::string> digests;
  hasher.add(origin);
  for (const Surface& surface : surfaces) {
    hasher.add(numbers[surface.material]);
    if (surface.instanced()) {
      add_instance(hasher, surface, digests);
      continue;
    }
    add_shape(hasher, surface);
    add_values(hasher, surface.normals);
    add_values(hasher, surface.primitive->uvs);
    if (!surface.primitive->uvs1.empty()) add_values(hasher, surface.primitive->uvs1);
    add_colors_and_tangents(hasher, *surface.primitive);
    if (!surface.tangents.empty()) add_values(hasher, surface.tangents);
  }
  return hasher.hex();
}

std::string materials_hash(const Scene& scene, std::span<const Material> materials, LeftOut left_out) {
  const std::vector<std::uint32_t> numbers = material_numbers(scene, left_out);
  std::vector<const Material*> ordered(materials.size(), nullptr);
  for (std::size_t m = 0; m < numbers.size(); ++m)
    if (numbers[m] != kNone) ordered[numbers[m]] = &materials[m];
  Hasher hasher;
  hasher.add(std::string_view("materials 2"));
  for (const Material* material : ordered) {
    if (!material) break;
    add_material(hasher, scene, *material);
    // Earlier versions stored light that had passed a plate as caustic light. The word makes such files stale.
    if (may_be_plate(*material)) hasher.add(std::string_view("plates"));
  }
  return hasher.hex();
}

std::string lights_hash(const Scene& scene, Vec3d origin, std::span<const PlacedLight> lights,
                        std::span<const Material> materials, std::span<const Surface> surfaces) {
  Hasher hasher;
  hasher.add(std::string_view("lights 1"));
  hasher.add(origin);
  hasher.add(std::uint64_t(lights.size()));
  for (const PlacedLight& placed : lights) {
    hasher.add(std::uint32_t(placed.light.kind));
    hasher.add(placed.light.intensity);
    if (placed.light.kind == PunctualLight::Kind::spot) {
      hasher.add(placed.light.inner_cone_rad);
      hasher.add(placed.light.outer_cone_rad);
    }
    if (placed.light.size != LampSize{}) {  // lights without size keep the hashes that they had before sizes were read
      hasher.add(std::string_view("size"));
      hasher.add(placed.light.size.radius_m);
      hasher.add(placed.light.size.angle_rad);
    }
    if (!placed.light.distant()) hasher.add(placed.position);
    if (placed.light.kind != PunctualLight::Kind::point) hasher.add(placed.direction);
  }
  for (const Surface& surface : surfaces) {
    const Material& material = materials[surface.material];
    if (!material.emissive()) continue;
    add_shape(hasher, surface);
    hasher.add(material.emission);
    hasher.add(std::uint32_t(material.double_sided));
    if (material.textures && material.textures->emission) {
      add_texture(hasher, scene, "emission", material.textures->emission);
      add_values(hasher, surface.primitive->uvs);
      if (material.textures->emission.uv_set == 1) add_values(hasher, surface.primitive->uvs1);
    }
  }
  if (scene.environment) hasher.add(std::string_view(scene.environment->hash));
  return hasher.hex();
}

std::string media_hash() { return hash_hex("media 1"); }

formats::Identity identity_of(const SceneFrame& frame) {
  const SceneHashes& h = frame.hashes;
  return {h.static_geometry, h.moving_geometry, h.materials, h.lights, h.media, frame.frame, frame.frame};
}

namespace {

/// Hashes the members that decide what a pinhole camera shows of a scene that stands still.
Hasher pinhole_hasher(const PlacedCamera& placed) {
  Hasher hasher;
  hasher.add(std::string_view("camera 3"));
  for (const CameraProperty& property : camera_properties())
    if (property.projects()) add_property(hasher, placed.camera, property);
  hasher.add(placed.scene_from_camera);
  return hasher;
}

}  // namespace

std::string pinhole_hash(const PlacedCamera& placed) { return pinhole_hasher(placed).hex(); }

std::string camera_hash(const PlacedCamera& placed) {
  Hasher hasher = pinhole_hasher(placed);
  for (const CameraProperty& property : camera_properties())
    if (!property.projects()) add_property(hasher, placed.camera, property);
  return hasher.hex();
}

}  // namespace tempolux
