// lib/scene/at_frame.h -- the scene at one frame: evaluated transforms, and triangles in scene space.
#pragma once

#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "formats/identity.h"
#include "lib/scene/scene.h"

namespace tempolux {

class Animator;
class Sharing;
class Media;  // lib/volume/medium.h

/// A material, light or camera that an animation changes within a segment (KHR_animation_pointer).
struct PropertyChange {
  std::string name, why;  ///< name of the object, and what changes: "Glass" and "roughness of Glass"
  std::string carries;    ///< kind of the changed object: "material", "light" or "camera"
};

/// An interval of frames within which static objects do not change (docs/methods/formulas.md). Both ends belong to it.
struct Segment {
  int first = 0, last = 0;
  /// For each node, 1 if its state differs between two frames: its world transform, the morph weights and joints of its
  /// mesh, its materials, its light, or whether it is seen. A node that is hidden does not move.
  std::vector<std::uint8_t> node_moves;
  /// For each node, 1 if it is hidden at all frames (KHR_node_visibility): its mesh has no surfaces, its light is
  /// absent.
  std::vector<std::uint8_t> node_hidden;
  std::vector<std::string> why_moves;   ///< for each node, what differs: "translation of MovingBox"; "": nothing
  std::vector<PropertyChange> changes;  ///< materials, lights and cameras that differ between two frames
  /// World position of scene space's origin. 0, unless the scene is so far from the world's origin that float32 would
  /// lose digits.
  Vec3d origin{};
  Box3d world_bounds;  ///< of all geometry over the whole segment, world space, m

  bool hides_at_times = false;  ///< true if a node is hidden at some frames, but not at all
  bool hides(std::uint32_t node) const { return node < node_hidden.size() && node_hidden[node] != 0; }
  /// True if the node's state differs between two frames. False in a scene made by hand, which has no nodes.
  bool moves(std::uint32_t node) const { return node < node_moves.size() && node_moves[node] != 0; }
};

/// How frames, segments and units of light follow from the file.
struct TimeOptions {
  double fps = 24;                  ///< frame f is at time f / fps seconds
  int segment_length = 24;          ///< frames; segments begin at multiples of it
  std::string light_units = "raw";  ///< "raw", or "spec": punctual lights are divided by 683
};

/// The frame that tools evaluate for `frame`: clamped to the animation's frames, which are 0 to the frame of the last
/// key (rounded up). Without animation only negative frames are clamped.
int frame_in_animation(const Scene& scene, int frame, const TimeOptions& options);

/// The segment that holds `frame`: frames k length to (k+1) length - 1, cut at the animation's last frame. A last
/// segment of less than half the length belongs to the segment before. Throws
/// std::invalid_argument unless fps and segment length are above 0; InputError if geometry overflows double.
Segment segment_of(const Scene& scene, int frame, const TimeOptions& options);

/// World transforms of all nodes at a frame. Frames outside the animation have its first or last state.
std::vector<Affine> world_from_node(const Scene& scene, int frame, const TimeOptions& options);

/// A constant array whose copies share memory: a static surface is stored once for all frames.
template <class T>
class SharedArray {
 public:
  SharedArray() = default;
  SharedArray(std::vector<T> values)
      : values_(values.empty() ? nullptr : std::make_shared<const std::vector<T>>(std::move(values))) {}
  SharedArray(std::initializer_list<T> values) : SharedArray(std::vector<T>(values)) {}

  std::size_t size() const { return values_ ? values_->size() : 0; }
  bool empty() const { return !values_; }
  const T* data() const { return values_ ? values_->data() : nullptr; }
  const T* begin() const { return data(); }
  const T* end() const { return data() + size(); }
  const T& operator[](std::size_t i) const { return (*values_)[i]; }

 private:
  std::shared_ptr<const std::vector<T>> values_;
};

/// The triangles of one primitive of one node, in scene space (world - Segment::origin). Cheap to copy.
/// A transform may shrink triangles to zero area at some frames. Such a triangle has a normal of zero, not NaN; no ray
/// hits it and it emits nothing. The surfaces of a node that is hidden at some frames only are shrunk to a point there.
/// If many nodes or instances share a large primitive, the surface is `instanced`: it stores no vertices, and
/// position() and normal() transform the primitive's. Both forms give the same numbers.
struct Surface {
  std::uint32_t object = 0;  ///< id.object
  std::uint32_t node = 0;
  std::uint32_t material = 0;
  bool flipped = false;                  ///< the transform mirrors: the front has the opposite winding
  const Primitive* primitive = nullptr;  ///< has triangles and uvs; the Scene owns it
  SharedArray<Vec3> positions;           ///< scene space, m; computed in double, rounded once; empty: instanced
  SharedArray<Vec3> normals;             ///< unit; empty: flat shading, or instanced
  SharedArray<Vec3> tangents;            ///< not unit; empty unless the shape deforms and the primitive has tangents
  Affine scene_from_node;                ///< includes the transform of an instance (Node::instances)

  bool instanced() const { return positions.empty(); }
  /// Scene space, m.
  Vec3 position(std::uint32_t vertex) const {
    return instanced() ? Vec3(scene_from_node.point(Vec3d(primitive->positions[vertex]))) : positions[vertex];
  }
  /// True if the surface has shading normals.
  bool smooth() const { return instanced() ? !primitive->normals.empty() : !normals.empty(); }
  /// Unit, scene space; only for a smooth surface.
  Vec3 normal(std::uint32_t vertex) const {
    return instanced() ? Vec3(normalize(scene_from_node.normal(Vec3d(primitive->normals[vertex])))) : normals[vertex];
  }
  /// Scene space, not unit; only for a primitive with tangents.
  Vec3 tangent(std::uint32_t vertex) const {
    return tangents.empty() ? Vec3(scene_from_node.direction(Vec3d(primitive->tangents[vertex]))) : tangents[vertex];
  }
};

/// A punctual light at a frame.
struct PlacedLight {
  PunctualLight light;
  Vec3 position;   ///< scene space, m
  Vec3 direction;  ///< unit, direction in which the light travels
  std::uint32_t node = 0;
};

/// A camera at a frame.
struct PlacedCamera {
  Camera camera;
  Affine scene_from_camera;  ///< a rotation and translation; columns: right, up, backward
};

/// Hashes of all that a stage may depend on, by concern; 32 hexadecimal digits each (formats/plan/plan.md).
struct SceneHashes {
  std::string camera;           ///< the only hash that is not part of any identity
  std::string static_geometry;  ///< of the segment
  std::string moving_geometry;  ///< at this frame
  std::string lights;           ///< punctual lights, emissive triangles with their emission at this frame, environment
  std::string materials;
  std::string media;
};

/// The scene evaluated at a frame. Owns its surfaces and points into the Scene, which must outlive it.
struct SceneFrame {
  const Scene* scene = nullptr;
  int frame = 0;  ///< the last whole frame up to time_s
  double time_s = 0;
  Segment segment;
  std::vector<Surface> surfaces;  ///< static surfaces first, then moving ones
  std::size_t static_count = 0;
  std::vector<Material> materials;              ///< evaluated
  std::shared_ptr<const TextureImages> images;  ///< images of the materials' textures; nullptr: none
  std::vector<PlacedLight> lights;
  const Environment* environment = nullptr;  ///< the scene's; nullptr: none
  std::shared_ptr<const Media> media;        ///< nullptr: none. SegmentScene::at() leaves it to the reader of volumes
  Vec3d origin{};                            ///< world position of the origin of scene space, m
  Box3 bounds;                               ///< of all geometry over the segment; scene space
  std::vector<Affine> world_from_node;       ///< per node, at this frame
  std::vector<Camera> cameras;               ///< evaluated
  SceneHashes hashes;

  /// The camera of a node at this frame; camera_node is an index into Scene::nodes, as Scene::camera_node returns it.
  /// Throws InputError if the node's transform leaves the camera without a direction.
  PlacedCamera camera(int camera_node) const;
};

/// Identity of the scene's state at this frame, for files that are made from the frame.
formats::Identity identity_of(const SceneFrame& frame);
/// Hash of one placed camera; SceneHashes::camera covers all cameras of the scene.
std::string camera_hash(const PlacedCamera& placed);
/// The same without lens and shutter: what points, records and decisions depend on.
std::string pinhole_hash(const PlacedCamera& placed);

/// A scene over one segment. Static objects are placed and hashed once and shared by all frames.
///
///     const SegmentScene stage(scene, segment_of(scene, 0, options), options);
///     for (int f = stage.segment().first; f <= stage.segment().last; ++f) use(stage.at(f));
///
/// The cost of at() is linear in the number of moving objects and independent of the static ones. Several threads may
/// call at(). The Scene must outlive this object.
class SegmentScene {
 public:
  /// Throws std::invalid_argument for unknown units of light; InputError if static geometry is out of the range of
  /// coordinates.
  SegmentScene(const Scene& scene, Segment segment, const TimeOptions& options);

  const Segment& segment() const { return segment_; }
  /// The scene at `frame`, which may lie between two frames (12.25) and must be in the segment (else
  /// std::invalid_argument). Throws InputError if a transform moves geometry or a light out of range.
  SceneFrame at(double frame) const;

 private:
  const Scene* scene_;
  Segment segment_;
  TimeOptions options_;
  std::shared_ptr<const Animator> animator_;
  std::vector<Surface> static_surfaces_;
  Box3 bounds_;
  std::string static_hash_, materials_hash_, media_hash_;
  std::shared_ptr<const Sharing> sharing_;
  bool materials_stay_ = true;
};

}  // namespace tempolux
