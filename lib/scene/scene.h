// lib/scene/scene.h -- a scene as plain data: nodes, meshes, materials, lights, cameras.
//
// Scene is the content of the file, independent of time; SceneFrame (at_frame.h) is its state at one frame.
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <memory>
#include <numbers>
#include <optional>
#include <string>
#include <vector>

#include "lib/core/affine.h"
#include "lib/core/vec.h"
#include "lib/image/texture_wrap.h"
#include "lib/scene/environment.h"

namespace tempolux {

class TextureImages;  // lib/image/texture_images.h

inline constexpr std::uint32_t kNone = 0xffffffffu;  ///< in place of an index: there is no such thing

/// Directions of a surface at one point that its material needs besides the shading normal; unit, scene space, of the
/// triangle's front side. Zero: there is none.
struct SurfaceAxes {
  Vec3 coat_normal{0, 0, 0};  ///< normal of the clearcoat; none: the shading normal
  Vec3 grain{0, 0, 0};        ///< direction along which anisotropy adds roughness, roughly perpendicular to the normal

  bool operator==(const SurfaceAxes&) const = default;
};
/// Surfaces of a smaller roughness are delta mirrors or smooth glass. At this roughness GGX has alpha = 4e-4, so
/// reflected directions spread by about 2 alpha = 8e-4 rad: a pixel of a picture of 1080 lines, whose height is 0.8
/// rad.
inline constexpr float kMirrorRoughness = 0.02f;

/// Properties of a material at one point: metallic-roughness of glTF 2.0 with the extensions that docs/scene-files.md
/// lists.
struct MaterialValues {
  Rgb base_color{1.0f};      ///< reflectance, each channel in [0, 1]
  float metallic = 1;        ///< [0, 1]
  float roughness = 1;       ///< perceptual, [0, 1]; GGX' alpha is roughness^2
  Rgb emission{0.0f};        ///< radiance [W/m^2/sr], strength included; from the back, too, if double_sided
  float specular = 1;        ///< KHR_materials_specular: factor of the dielectric lobe, [0, 1]
  Rgb specular_color{1.0f};  ///< tint of F0, >= 0
  float ior = 1.5f;          ///< >= 1, or 0
  float transmission = 0;    ///< KHR_materials_transmission, [0, 1]: replaces this share of the Lambert lobe
  bool thin_walled = true;   ///< false: the boundary of a refracting solid (KHR_materials_volume)
  /// KHR_materials_volume: transmittance of a path of length attenuation_distance [m, > 0] inside a solid.
  Rgb attenuation_color{1.0f};
  float attenuation_distance = std::numeric_limits<float>::infinity();
  float dispersion = 0;  ///< KHR_materials_dispersion: 20 / Abbe number of a solid, >= 0 (lib/material/dispersion.h)
  bool double_sided = false;
  bool unlit = false;             ///< KHR_materials_unlit: shows base_color to camera and mirrors, scatters nothing
  float clearcoat = 0;            ///< KHR_materials_clearcoat: factor of the coat's Fresnel term, [0, 1]
  float clearcoat_roughness = 0;  ///< perceptual, [0, 1]
  float iridescence = 0;          ///< KHR_materials_iridescence: share of the reflection that has a thin film, [0, 1]
  float iridescence_ior = 1.3f;   ///< index of the film, >= 1
  /// Thickness of the film [nm, >= 0] where its texture is 0, and where the texture is 1 or missing.
  float iridescence_thickness_minimum = 100, iridescence_thickness_maximum = 400;
  Rgb sheen_color{0.0f};          ///< KHR_materials_sheen, [0, 1]
  float sheen_roughness = 0;      ///< perceptual, [0, 1]
  float anisotropy = 0;           ///< KHR_materials_anisotropy: strength, [0, 1]
  float anisotropy_rotation = 0;  ///< from the surface's tangent, counter-clockwise
  /// KHR_materials_diffuse_transmission: share of the light below gloss and coats that leaves the surface on its far
  /// side (lib/material/diffuse_transmission.h), [0, 1]. The rest is reflected in base_color.
  float diffuse_transmission = 0;
  Rgb diffuse_transmission_color{1.0f};  ///< colour of the light that leaves on the far side, [0, 1]
  SurfaceAxes axes;                      ///< at a hit; SurfaceMaterial sets them
  bool from_far_side = false;            ///< at a hit: the path goes on from the far side

  /// True if the material emits light where its texture is not black.
  bool emissive() const { return max_component(emission) > 0; }
  bool operator==(const MaterialValues&) const = default;
};

/// A material's reference to a texture.
struct Texture {
  using Wrap = TextureWrap;
  std::uint32_t image = kNone;  ///< index into Scene::images; kNone: no texture
  std::uint32_t uv_set = 0;     ///< 0: Primitive::uvs, 1: uvs1
  Wrap wrap_u = Wrap::repeat, wrap_v = Wrap::repeat;
  bool nearest = false;  ///< true: magnified texels have sharp edges; false: bilinear interpolation
  /// KHR_texture_transform: u' = m[0] u + m[1] v + m[2], v' = m[3] u + m[4] v + m[5].
  std::array<float, 6> transform{1, 0, 0, 0, 1, 0};

  explicit operator bool() const { return image != kNone; }
  bool operator==(const Texture&) const = default;
};

/// The textures of a material; each multiplies the property of its name. Vertex colours multiply base colour and alpha.
struct MaterialTextures {
  Texture base_color;                  ///< sRGB; its A multiplies Material::alpha
  Texture metallic_roughness;          ///< linear: B metallic, G roughness
  Texture normal;                      ///< linear: tangent space, (2 rgb - 1) times (scale, scale, 1)
  Texture emission;                    ///< sRGB
  Texture transmission;                ///< linear: R
  Texture specular;                    ///< linear: A
  Texture specular_color;              ///< sRGB
  Texture clearcoat;                   ///< linear: R
  Texture clearcoat_roughness;         ///< linear: G
  Texture clearcoat_normal;            ///< as normal; without it the coat has the smooth normal
  Texture sheen_color;                 ///< sRGB
  Texture sheen_roughness;             ///< linear: A
  Texture anisotropy;                  ///< linear: RG direction of the grain, (2 rg - 1), before rotation; B strength
  Texture diffuse_transmission;        ///< linear: A
  Texture diffuse_transmission_color;  ///< sRGB
  /// Linear: R the film's share; G its thickness, from the minimum to the maximum.
  Texture iridescence, iridescence_thickness;
  float normal_scale = 1, clearcoat_normal_scale = 1;
  bool grain = false;          ///< true if the material has anisotropy, so that primitives need tangents
  bool vertex_colors = false;  ///< true if some primitives of the material have Primitive::colors

  bool any() const {
    return base_color || metallic_roughness || normal || emission || transmission || specular || specular_color ||
           clearcoat || clearcoat_roughness || clearcoat_normal || iridescence || iridescence_thickness ||
           sheen_color || sheen_roughness || anisotropy || diffuse_transmission || diffuse_transmission_color ||
           grain || vertex_colors;
  }
  /// The texture whose coordinates give a primitive its tangents; nullptr: the material needs none.
  const Texture* along_tangents() const {
    return normal ? &normal : clearcoat_normal ? &clearcoat_normal : grain ? &anisotropy : nullptr;
  }
  bool operator==(const MaterialTextures&) const = default;
};

/// A material of the scene: its factors, and the textures that multiply them.
struct Material : MaterialValues {
  enum class Alpha : std::uint8_t { opaque, mask, blend };
  std::string name;
  Alpha alpha_mode = Alpha::opaque;
  float alpha = 1;                           ///< blend: share of rays that meet the surface
  float alpha_cutoff = 0.5f;                 ///< mask: no ray meets the surface where alpha is smaller
  std::optional<MaterialTextures> textures;  ///< empty if the material has none

  bool operator==(const Material&) const = default;
};

/// The displacement that a morph target of weight 1 adds to every vertex.
struct MorphTarget {
  std::vector<Vec3> positions, normals, tangents;  ///< an empty array adds nothing
};

/// The influence of one joint on a vertex.
struct Influence {
  std::uint16_t joint = 0;  ///< index into Skin::joints
  float weight = 0;         ///< weights of a vertex sum to 1
};

/// The triangles of one glTF primitive, in the space of its node.
struct Primitive {
  std::vector<Vec3> positions;  ///< m, node space, at rest
  std::vector<Vec3> normals;    ///< unit; empty: flat shading
  std::vector<Vec2> uvs, uvs1;  ///< the two sets that the material reads; empty: none
  /// COLOR_0, linear, in [0, 1]: multiplies base colour and alpha, interpolated linearly. Empty: 1.
  std::vector<std::array<float, 4>> colors;
  /// For each vertex, the direction of the normal map's x axis, and a sign: +1 if the map's y axis has the direction
  /// normal x tangent, -1 if the opposite. Only primitives with normals and a normal map have tangents. If empty,
  /// texture lookups take the axes from the texture coordinates.
  std::vector<Vec3> tangents;
  std::vector<float> tangent_sides;
  std::vector<std::array<std::uint32_t, 3>> triangles;  ///< counter-clockwise seen from the front
  std::uint32_t material = 0;                           ///< index into Scene::materials
  std::vector<MorphTarget> targets;
  std::vector<Influence> influences;      ///< influences_per_vertex for each vertex
  std::size_t influences_per_vertex = 0;  ///< 0: no skin moves the primitive
};

/// Replaces the primitive's vertices by copies of its own vertices `sources`, in this order. Triangles keep their
/// indices.
void take_vertices(Primitive& primitive, const std::vector<std::uint32_t>& sources);

/// A mesh of the file: primitives that share nodes.
struct Mesh {
  std::string name;
  std::vector<Primitive> primitives;  ///< all with the same number of morph targets
};

/// Joints that move a mesh: a vertex is at the sum of weight x world_from_joint x joint_from_mesh x position.
struct Skin {
  std::vector<int> joints;              ///< nodes
  std::vector<Affine> joint_from_mesh;  ///< inverse bind matrices
};

/// A camera looks along its node's -Z, with +Y up. A member must have a row in camera_properties.cpp.
struct Camera {
  enum class Kind { perspective, orthographic };
  enum class Shutter { centre, start, end };  ///< where the frame's time lies in the time the shutter is open
  std::string name;
  Kind kind = Kind::perspective;
  double yfov_rad = 0.8;  ///< full vertical angle, perspective
  double ymag_m = 1;      ///< half height of the view, orthographic
  /// Where the picture's centre lies off the view axis, in heights of the picture: x to the right, y up.
  std::array<double, 2> lens_shift{};
  // From the node's extras or the options.
  double lens_radius_m = 0;    ///< of the opening; above 0 it counts, and f_stop does not
  double f_stop = 0;           ///< focal length / diameter of the opening; 0: a pinhole
  double lens_mm = 0;          ///< focal length; 0: follows from sensor and angle of view
  double sensor_width_mm = 0;  ///< along the longer side of the picture; 0: kSensorWidth_mm
  double focus_m = 0;          ///< distance of what is sharp, along the view axis; 0: not known; may be infinite
  double shutter_frames = 0;   ///< time the shutter is open, in frames; 0: an instant
  Shutter shutter = Shutter::centre;

  /// True if the lens is open, so that things off the plane of focus are blurred. An orthographic camera has no lens.
  bool has_lens() const { return kind == Kind::perspective && (lens_radius_m > 0 || f_stop > 0); }
};

/// Width of a full-frame sensor, and Blender's default.
inline constexpr double kSensorWidth_mm = 36;

/// Radius [m] of a camera's open lens. half: half of the picture's longer side at distance 1.
inline double lens_radius(const Camera& camera, double half) {
  if (camera.lens_radius_m > 0) return camera.lens_radius_m;
  const double sensor = camera.sensor_width_mm > 0 ? camera.sensor_width_mm : kSensorWidth_mm;
  const double focal_mm = camera.lens_mm > 0 ? camera.lens_mm : sensor / 2 / half;
  return focal_mm / 1000 / (2 * camera.f_stop);
}

/// A camera's lens and shutter as the `extras` of its node say them (the exporter for Blender writes them).
struct CameraExtras {
  int first_frame = 0;
  /// One list for each row of the table in camera_properties.h: a single number for all frames, or one number per frame
  /// from `first_frame` on; empty: the file does not have the property.
  std::vector<std::vector<double>> lists;
  /// Node on which the camera is focused, whatever `lists` say: focus_m is its distance along the view axis. -1: none.
  int focus_node = -1;

  /// Sets lens and shutter of a camera to their values at a frame; frames outside of a list have its first or last one.
  void apply(int frame, Camera& camera) const;
  /// True if a list has different values.
  bool changes() const;
  /// Replaces the list of a member of Camera by one number for all frames.
  void set(double Camera::*member, double number);
};

/// Largest inner cone of a spot, as a share of the outer cone. Blender writes inner = outer for a spot without a soft
/// edge, which glTF forbids.
inline constexpr double kSharpestSpot = 0.9999;
/// Bounds of the outer cone's angle, rad. The lower one replaces an angle of 0 or less.
inline constexpr double kNarrowestSpot = 1e-12, kWidestSpot = std::numbers::pi / 2 + 1e-6;

/// The size of a punctual light. glTF has no such property; `extras` say it (lamp_size.h). With the size 0 shadows are
/// sharp. Rays never meet the light, whatever its size: light samples and photons alone find it.
struct LampSize {
  float radius_m = 0;   ///< of a point or spot light, which is a sphere
  float angle_rad = 0;  ///< of a directional light, which is a disc of this angular diameter; at most pi

  bool operator==(const LampSize&) const = default;
};

/// A light of KHR_lights_punctual. It shines along the node's -Z; the node's scale has no effect. Light sampling,
/// emission of photons and flux use the same falloff (SpotProfile in lib/light/punctual.h). A member that changes the
/// light must enter lights_hash(), else files of the old light are reused.
struct PunctualLight {
  enum class Kind { point, spot, directional };
  std::string name;
  Kind kind = Kind::point;
  Rgb intensity{1.0f};  ///< colour x intensity: W/sr (point, spot) or W/m^2 (directional)
  float inner_cone_rad = 0, outer_cone_rad = 0.785398f;  ///< spot: half angles
  LampSize size;

  /// True if the light is infinitely far away and has a direction in place of a position.
  bool distant() const { return kind == Kind::directional; }
  bool has_size() const { return size.radius_m > 0 || size.angle_rad > 0; }
  bool operator==(const PunctualLight&) const = default;
};

/// A node of the file's graph, and what it carries.
struct Node {
  std::string name;
  int parent = -1;                 ///< smaller than the node's own index: parents come first
  std::uint32_t source_index = 0;  ///< index in the file, for messages
  // parent_from_node at rest: translation x rotation x scale, or the matrix if has_matrix. A matrix
  // cannot be animated.
  Vec3d translation{};
  std::array<double, 4> rotation{0, 0, 0, 1};  ///< unit quaternion x y z w
  Vec3d scale{1, 1, 1};
  bool has_matrix = false;
  Affine parent_from_node{};
  int mesh = -1, camera = -1, light = -1;  ///< -1: none
  int skin = -1;                           ///< -1: none. Skinned primitives ignore the node's transform
  std::vector<double> weights;             ///< morph weights of the mesh at rest
  /// EXT_mesh_gpu_instancing: node_from_instance of each occurrence of the mesh. Empty: one occurrence, not
  /// transformed.
  std::vector<Affine> instances;
  std::uint32_t object = kNone;  ///< id.object of its mesh: 0, 1, 2 ... in node order
  std::string extras;            ///< the node's custom properties as JSON text; empty: none
  CameraExtras camera_extras;    ///< of a node with a camera
  LampSize lamp_size;            ///< of its light, if the light itself says no size
  /// KHR_node_visibility at rest. A node is seen if it and all its ancestors are visible.
  bool visible = true;
  /// True if the node is hidden at all times: the node or an ancestor is not visible at rest, and no animation makes it
  /// visible. The reader leaves out the node's mesh and light.
  bool never_seen = false;
};

/// One animated property: values at increasing times.
struct AnimationTrack {
  enum class Path {
    // of a node
    translation,
    rotation,
    scale,
    weights,
    visible,   ///< Node::visible: 0 is false; always with steps
    material,  ///< a property of a material
    // of a light
    light_color,
    light_intensity,
    inner_cone,
    outer_cone,
    // of a camera
    yfov,
    ymag
  };
  enum class Interpolation { linear, step, cubic_spline };
  int target = 0;  ///< index of the node, material, light or camera
  Path path = Path::translation;
  std::size_t property = 0;  ///< of a material: row of material_properties()
  Interpolation interpolation = Interpolation::linear;
  std::size_t components = 3;   ///< numbers per value: 4 for a rotation, one per morph target for weights
  std::vector<double> times_s;  ///< strictly increasing
  std::vector<double> values;   ///< `components` numbers per key; a spline has in-tangent, value, out-tangent per key
};

/// The factors of an emission or intensity: KHR_animation_pointer may animate only one of them.
struct ColorFactors {
  Rgb color{1.0f};
  float strength = 1;
};

/// Tracks that play together.
struct Animation {
  std::string name;
  std::vector<AnimationTrack> tracks;
};

/// A scene as its file describes it. load_gltf builds it.
struct Scene {
  std::string path;                ///< as given, for messages
  std::string generator;           ///< the program that wrote the file; may be empty
  std::vector<std::string> files;  ///< all files that were read: the scene, its buffers and images
  std::vector<Node> nodes;         ///< parents before children; only the default scene's nodes
  std::vector<Mesh> meshes;
  std::vector<Material> materials;              ///< never empty: a primitive without material uses the last one
  std::shared_ptr<const TextureImages> images;  ///< the images that textures of materials name; nullptr: none
  std::vector<Camera> cameras;
  std::vector<PunctualLight> lights;
  std::shared_ptr<const Environment> environment;  ///< nullptr: none. glTF has no environment; callers set it
  std::vector<Skin> skins;
  std::vector<ColorFactors> emission_factors,
      light_factors;                      ///< by material and by light, at rest; empty: not animated
  std::vector<Animation> animations;      ///< all play at once (GltfOptions::animation selects one)
  std::vector<std::string> object_names;  ///< by object id
  double duration_s = 0;                  ///< time of the last key of all animations
  std::vector<std::string> warnings;      ///< ignored features, one line each

  /// True if a node of the scene has a camera.
  bool has_camera() const;
  /// True if there is light from outside of the scene: an environment, or a node with a directional light.
  bool has_distant_light() const;
  /// Index into `nodes` of the node whose camera has this name, or which has this name itself. An unnamed camera is
  /// called "camera INDEX"; "auto" is the first camera in the file. Throws InputError that lists the names, or explains
  /// how to export cameras.
  int camera_node(const std::string& name) const;
};

/// Throws InputError, which names the exporter's option, unless something in the scene emits light: a punctual light,
/// an emissive material on some triangle, or the environment.
void require_lights(const Scene& scene);

}  // namespace tempolux
