// lib/scene/scene.h -- a scene as plain data: nodes, meshes, materials, lights, cameras.
//
// Scene is what the file says, independent of time; SceneFrame (at_frame.h) is its state at one frame.
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "lib/core/affine.h"
#include "lib/core/vec.h"
#include "lib/image/texture_wrap.h"
#include "lib/scene/environment.h"

namespace tempolux {

class TextureImages;  // lib/image/texture_images.h

inline constexpr std::uint32_t kNone = 0xffffffffu;

/// What a material is at one point: metallic-roughness of glTF 2.0 with the extensions that docs/scene-files.md lists.
struct MaterialValues {
  Rgb base_color{1.0f};         ///< reflectance, each channel in [0, 1]
  float metallic = 1;           ///< [0, 1]
  float roughness = 1;          ///< perceptual, [0, 1]; alpha of GGX = roughness^2
  Rgb emission{0.0f};           ///< radiance [glTF nits], strength included; back too if double_sided
  float specular = 1;           ///< KHR_materials_specular: factor of the dielectric lobe, [0, 1]
  Rgb specular_color{1.0f};     ///< tint of F0, >= 0
  float ior = 1.5f;             ///< >= 1, or 0
  float transmission = 0;       ///< KHR_materials_transmission, [0, 1]: in place of the Lambert lobe
  bool thin_walled = true;      ///< false: boundary of a solid (KHR_materials_volume), which refracts
  Rgb attenuation_color{1.0f};  ///< KHR_materials_volume: share of white light left inside a solid ...
  float attenuation_distance = std::numeric_limits<float>::infinity();  ///< ... after this way, m, > 0
  bool double_sided = false;
  bool unlit = false;  ///< KHR_materials_unlit: shows base_color to eye and mirror, scatters nothing

  bool emissive() const { return max_component(emission) > 0; }
  bool operator==(const MaterialValues&) const = default;
};

/// A texture as a material refers to it.
struct Texture {
  using Wrap = TextureWrap;
  std::uint32_t image = kNone;  ///< number in Scene::images; kNone: no texture
  std::uint32_t uv_set = 0;     ///< TEXCOORD_n of the primitive
  Wrap wrap_u = Wrap::repeat, wrap_v = Wrap::repeat;
  bool nearest = false;  ///< magnified without interpolation
  /// KHR_texture_transform: u' = m[0] u + m[1] v + m[2], v' = m[3] u + m[4] v + m[5].
  std::array<float, 6> transform{1, 0, 0, 0, 1, 0};

  explicit operator bool() const { return image != kNone; }
  bool operator==(const Texture&) const = default;
};

/// The textures of a material; each multiplies the value of its name. So do colours of vertices, which are read as if
/// they were one.
struct MaterialTextures {
  Texture base_color;          ///< sRGB; its A multiplies Material::alpha
  Texture metallic_roughness;  ///< linear: B metallic, G roughness
  Texture normal;              ///< linear: tangent space, (2 rgb - 1) times (scale, scale, 1)
  Texture emission;            ///< sRGB
  Texture transmission;        ///< linear: R
  float normal_scale = 1;
  bool vertex_colors = false;  ///< some of its primitives have Primitive::colors

  bool any() const { return base_color || metallic_roughness || normal || emission || transmission || vertex_colors; }
  bool operator==(const MaterialTextures&) const = default;
};

/// A material of the scene: its factors, and the textures that multiply them.
struct Material : MaterialValues {
  enum class Alpha : std::uint8_t { opaque, mask, blend };
  std::string name;
  Alpha alpha_mode = Alpha::opaque;
  float alpha = 1;                           ///< share of rays that meet the surface (blend)
  float alpha_cutoff = 0.5f;                 ///< below, the surface is not there (mask)
  std::optional<MaterialTextures> textures;  ///< none for most materials: they cost one test then

  bool operator==(const Material&) const = default;
};

/// What a morph target adds to every vertex, times its weight.
struct MorphTarget {
  std::vector<Vec3> positions, normals, tangents;  ///< each may be empty: adds nothing
};

/// One joint's share in a vertex.
struct Influence {
  std::uint16_t joint = 0;  ///< index into Skin::joints
  float weight = 0;         ///< those of a vertex sum to 1
};

/// Triangles of one glTF primitive in the space of its node.
struct Primitive {
  std::vector<Vec3> positions;  ///< m, node space, at rest
  std::vector<Vec3> normals;    ///< unit; empty: flat shading
  std::vector<Vec2> uvs, uvs1;  ///< TEXCOORD_0, TEXCOORD_1; empty: none
  /// COLOR_0, linear, in [0, 1]: multiplies base colour and alpha; between corners linear. Empty: 1.
  std::vector<std::array<float, 4>> colors;
  /// Where the normal map's x points, and on which side of it y: +1 along normal x tangent, -1 against. Empty: as the
  /// texture coordinates say. Only of primitives with normals and a normal map.
  std::vector<Vec3> tangents;
  std::vector<float> tangent_sides;
  std::vector<std::array<std::uint32_t, 3>> triangles;  ///< counter-clockwise seen from the front
  std::uint32_t material = 0;                           ///< index into Scene::materials
  std::vector<MorphTarget> targets;
  std::vector<Influence> influences;      ///< influences_per_vertex for each vertex
  std::size_t influences_per_vertex = 0;  ///< 0: a skin does not move it
};

/// Gives the primitive other vertices: copies of its own by number, in this order. Its triangles stay as they are.
void take_vertices(Primitive& primitive, const std::vector<std::uint32_t>& sources);

struct Mesh {
  std::string name;
  std::vector<Primitive> primitives;  ///< all with the same number of morph targets
};

/// Joints that carry a mesh: a vertex is at sum of weight x world_from_joint x joint_from_mesh x position.
struct Skin {
  std::vector<int> joints;              ///< nodes
  std::vector<Affine> joint_from_mesh;  ///< inverse bind matrices
};

struct Camera {
  enum class Kind { perspective, orthographic };
  std::string name;
  Kind kind = Kind::perspective;
  double yfov_rad = 0.8;             ///< full vertical angle, perspective
  double ymag_m = 1;                 ///< half height of the view, orthographic
  double z_near_m = 0, z_far_m = 0;  ///< far 0: none. Information only: nothing is clipped.
};

/// KHR_lights_punctual. Shines down the node's -Z; the node's scale does not change it.
struct PunctualLight {
  enum class Kind { point, spot, directional };
  std::string name;
  Kind kind = Kind::point;
  Rgb intensity{1.0f};  ///< colour x intensity: W/sr (point, spot) or W/m^2 (directional)
  float inner_cone_rad = 0, outer_cone_rad = 0.785398f;  ///< spot: half angles

  bool operator==(const PunctualLight&) const = default;
};

struct Node {
  std::string name;
  int parent = -1;                 ///< always below its own index: nodes are sorted parents first
  std::uint32_t source_index = 0;  ///< index in the file, for messages
  // Local transform at rest, as T R S; a file's matrix (no animation allowed then) is in `matrix`.
  Vec3d translation{};
  std::array<double, 4> rotation{0, 0, 0, 1};  ///< unit quaternion x y z w
  Vec3d scale{1, 1, 1};
  bool has_matrix = false;
  Affine matrix{};
  int mesh = -1, camera = -1, light = -1;  ///< -1: none
  int skin = -1;                  ///< -1: none; else the mesh's skinned primitives ignore the node's own transform
  std::vector<double> weights;    ///< of its mesh's morph targets at rest
  std::vector<Affine> instances;  ///< EXT_mesh_gpu_instancing, node_from_instance: the mesh stands at each; empty: once
  std::uint32_t object = kNone;   ///< id.object of its mesh: 0, 1, 2 ... in node order
  std::string extras;             ///< its own properties as JSON text; empty: none
};

/// One animated property: keys at increasing times.
struct AnimationTrack {
  enum class Path {
    translation,
    rotation,
    scale,
    weights,  // of a node
    base_color,
    alpha_cutoff,
    metallic,
    roughness,
    emissive_factor,
    emissive_strength,
    specular,
    specular_color,
    ior,
    transmission,  // of a material
    light_color,
    light_intensity,
    inner_cone,
    outer_cone,  // of a light
    yfov,
    ymag  // of a camera
  };
  enum class Interpolation { linear, step, cubic_spline };
  int target = 0;  ///< index of the node, material, light or camera
  Path path = Path::translation;
  Interpolation interpolation = Interpolation::linear;
  std::size_t components = 3;   ///< numbers per value: 4 of a rotation, one per morph target
  std::vector<double> times_s;  ///< strictly increasing
  std::vector<double> values;   ///< value after value; spline: in-tangent, value, out-tangent of each key
};

/// What a colour is the product of, where KHR_animation_pointer may change one factor and not the other.
struct ColorFactors {
  Rgb color{1.0f};
  float strength = 1;
};

struct Animation {
  std::string name;
  std::vector<AnimationTrack> tracks;
};

/// A scene as its file describes it. Built by load_gltf.
struct Scene {
  std::string path;                ///< as given, for messages
  std::string generator;           ///< the program that wrote the file, as it says; may be empty
  std::vector<std::string> files;  ///< every file that was read: the scene, its buffers and images
  std::vector<Node> nodes;         ///< parents before children; the default scene's nodes only
  std::vector<Mesh> meshes;
  std::vector<Material> materials;              ///< never empty: a primitive without one uses the last
  std::shared_ptr<const TextureImages> images;  ///< those that a material's texture names; null: there are none
  std::vector<Camera> cameras;
  std::vector<PunctualLight> lights;
  std::shared_ptr<const Environment> environment;  ///< nullptr: none. glTF has none, callers set it
  std::vector<Skin> skins;
  std::vector<ColorFactors> emission_factors, light_factors;  ///< by material, by light, at rest
  std::vector<Animation> animations;                          ///< all play together (GltfOptions::animation chose them)
  std::vector<std::string> object_names;                      ///< by object id
  double duration_s = 0;                                      ///< last key of all animations
  std::vector<std::string> warnings;                          ///< what was ignored, one line each

  /// True if a node of the scene has a camera.
  bool has_camera() const;
  /// Index into nodes of the camera to use, by camera or node name (an unnamed one is "camera INDEX"); "auto" is the
  /// first in the file.
  /// Throws InputError that lists the names, or says how to export cameras.
  int camera_node(const std::string& name) const;
};

/// Throws InputError, with the exporter box to tick, unless something in the scene emits: a punctual light,
/// an emissive material on some triangle, or its environment. For tools that cannot work without light.
void require_lights(const Scene& scene);

}  // namespace tempolux
