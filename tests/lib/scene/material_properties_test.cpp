// Every member of a material, a lamp, a camera and a medium counts in the hash that stages compare: stale photons are
// never taken for current ones.
#include "lib/scene/material_properties.h"

#include <algorithm>
#include <array>
#include <set>

#include "lib/image/texture_images.h"
#include "lib/scene/camera_properties.h"
#include "lib/scene/scene_hash.h"
#include "tests/lib/scene/gltf_maker.h"
#include "tests/support/media.h"
#include "tests/support/scene_at_frame.h"

namespace tempolux {
namespace {

/// Other values than those of room(), for each type of member.
void flip(float& x) { x = x == 0.25f ? 0.5f : 0.25f; }
void flip(double& x) { x = x == 0.25 ? 0.5 : 0.25; }
void flip(std::array<double, 2>& x) { x[1] += 0.25; }
void flip(bool& x) { x = !x; }
void flip(Rgb& x) { x.g = x.g == 0.25f ? 0.5f : 0.25f; }
void flip(Texture& x) { x.transform[2] += 0.5f; }
template <class E>
requires std::is_enum_v<E>
void flip(E& x) { x = E(int(x) == 0 ? 1 : 0); }

/// Flips member number n of those given; false if there is none.
template <class... Members>
bool flip_one(int n, Members&... members) {
  int i = 0;
  ((i++ == n ? flip(members) : void()), ...);
  return n < i;
}
// A new member of these structures does not compile here: it must count in a hash, too.
bool flip_member(MaterialValues& m, int n) {
  auto& [base_color, metallic, roughness, emission, specular, specular_color, ior, transmission, thin_walled,
         attenuation_color, attenuation_distance, dispersion, double_sided, unlit, clearcoat, clearcoat_roughness,
         iridescence, iridescence_ior, iridescence_thickness_minimum, iridescence_thickness_maximum, sheen_color,
         sheen_roughness, anisotropy, anisotropy_rotation, diffuse_transmission, diffuse_transmission_color, axes,
         from_far_side] = m;
  return flip_one(n, base_color, metallic, roughness, emission, specular, specular_color, ior, transmission,
                  thin_walled, attenuation_color, attenuation_distance, dispersion, double_sided, unlit, clearcoat,
                  clearcoat_roughness, iridescence, iridescence_ior, iridescence_thickness_minimum,
                  iridescence_thickness_maximum, sheen_color, sheen_roughness, anisotropy, anisotropy_rotation,
                  diffuse_transmission, diffuse_transmission_color);
}
bool flip_member(MaterialTextures& t, int n) {
  auto& [base_color, metallic_roughness, normal, emission, transmission, specular, specular_color, clearcoat,
         clearcoat_roughness, clearcoat_normal, sheen_color, sheen_roughness, anisotropy, diffuse_transmission,
         diffuse_transmission_color, iridescence, iridescence_thickness, normal_scale, clearcoat_normal_scale, grain,
         vertex_colors] = t;
  return flip_one(n, base_color, metallic_roughness, normal, emission, transmission, specular, specular_color,
                  clearcoat, clearcoat_roughness, clearcoat_normal, sheen_color, sheen_roughness, anisotropy,
                  diffuse_transmission, diffuse_transmission_color, iridescence, iridescence_thickness, normal_scale,
                  clearcoat_normal_scale);
}
bool flip_member(PunctualLight& l, int n) {
  auto& [name, kind, intensity, inner, outer, size] = l;
  return flip_one(n, kind, intensity, inner, outer, size.radius_m, size.angle_rad);
}
bool flip_member(MediumOptions& o, int n) {
  auto& [sigma_t, albedo, g] = o;
  return flip_one(n, sigma_t, albedo, g);
}

/// A scene with a floor that has all textures, a lamp of light and a spot.
GltfMaker room() {
  GltfMaker maker;
  maker.add_material({{"name", "Grey"}, {"emissiveFactor", {1, 1, 1}}});
  maker.add_node({{"name", "Floor"}, {"mesh", maker.add_square(0)}});
  maker.add_light({{"type", "spot"}, {"intensity", 3}, {"spot", {{"outerConeAngle", 0.7}}}}, {{"name", "Spot"}});
  maker.add_camera({{"name", "Camera"}, {"translation", {0, 0, 5}}});
  return maker;
}

/// All hashes of the scene in one text.
std::string hashes_of(const Scene& scene) {
  const SceneHashes h = scene_at_frame(scene, segment_of(scene, 0, {}), 0, {}).hashes;
  return h.camera + h.static_geometry + h.moving_geometry + h.lights + h.materials + h.media;
}

/// Expects that flipping each member of part(scene) changes the hashes.
template <class Part>
void expect_that_members_count(const Scene& scene, const Part& part) {
  const std::string before = hashes_of(scene);
  for (int n = 0;; ++n) {
    Scene changed = scene;
    if (!flip_member(part(changed), n)) break;
    EXPECT_NE(hashes_of(changed), before) << "member " << n;
  }
}

TEST(MaterialProperties, EveryMemberCounts) {
  const Scene scene = room().load();
  expect_that_members_count(scene, [](Scene& s) -> MaterialValues& { return s.materials[0]; });
}

TEST(MaterialProperties, EveryTextureCounts) {
  Scene scene = room().load();
  scene.images = std::make_shared<const TextureImages>(std::vector<EncodedImage>{{"", {}, 1, 1, "digest"}});
  MaterialTextures textures;
  for (const MaterialTexture& texture : material_textures()) (textures.*texture.member).image = 0;
  scene.materials[0].textures = textures;
  expect_that_members_count(scene, [](Scene& s) -> MaterialTextures& { return *s.materials[0].textures; });
}

TEST(MaterialProperties, EveryMemberOfAlphaCounts) {
  for (const auto mode : {Material::Alpha::mask, Material::Alpha::blend}) {
    Scene scene = room().load();
    scene.materials[0].alpha_mode = mode;
    const std::string before = hashes_of(scene);
    scene.materials[0].alpha = 0.25f;
    EXPECT_NE(hashes_of(scene), before);
  }
  Scene scene = room().load();
  const std::string before = hashes_of(scene);
  scene.materials[0].alpha_mode = Material::Alpha::mask;
  const std::string masked = hashes_of(scene);
  EXPECT_NE(masked, before);
  scene.materials[0].alpha_cutoff = 0.25f;
  EXPECT_NE(hashes_of(scene), masked);
}

TEST(MaterialProperties, EveryMemberOfALightCounts) {
  const Scene scene = room().load();
  expect_that_members_count(scene, [](Scene& s) -> PunctualLight& { return s.lights[0]; });
}

TEST(MaterialProperties, EveryMemberOfACameraCounts) {
  Scene scene = room().load();
  scene.cameras[0].f_stop = 2.8;  // members of a lens count where it is open
  const std::string before = hashes_of(scene);
  for (const CameraProperty& property : camera_properties()) {
    if (property.role == CameraRole::orthographic) continue;  // room() has a perspective camera
    Scene changed = scene;
    std::visit([&](auto member) { flip(changed.cameras[0].*member); }, property.member);
    EXPECT_NE(hashes_of(changed), before) << property.key;
  }
}

TEST(MaterialProperties, EveryMemberOfAMediumCounts) {
  const MediumOptions options;
  const std::string before = test::cube_of_medium({}, 1, options)->hash();
  for (int n = 0;; ++n) {
    MediumOptions changed = options;
    if (!flip_member(changed, n)) break;
    EXPECT_NE(test::cube_of_medium({}, 1, changed)->hash(), before) << "member " << n;
  }
}

/// Each row has a name and a pointer of its own, and is set by its numbers.
TEST(MaterialProperties, RowsAreDistinctAndSet) {
  std::set<std::string> names;
  std::set<std::string_view> pointers;
  for (const MaterialProperty& property : material_properties()) {
    names.insert(property.name);
    pointers.insert(property.pointer);
    Material material;
    ColorFactors emission{Rgb{0.0f}, 1};
    for (const double number : {0.25, 0.0, 2.0}) {
      const std::vector<double> numbers(property.components(), number);
      set_property(property, numbers, material, emission);
      finish_emission(emission, material);
      const float limited = float(std::clamp(number, property.lower, property.upper));
      const auto* one = std::get_if<float Material::*>(&property.member);
      if (!one) continue;
      EXPECT_EQ(material.**one, property.role == PropertyRole::value_or_zero && number == 0 ? 0 : limited)
          << property.name;
    }
  }
  EXPECT_EQ(names.size(), material_properties().size());
  EXPECT_EQ(pointers.size(), material_properties().size());
}

}  // namespace
}  // namespace tempolux
