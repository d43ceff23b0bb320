// lib/scene/at_frame.h -- the scene at one frame: transforms evaluated, triangles in scene space.
#pragma once

#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "lib/scene/scene.h"

namespace tempolux {

class Animator;
class Sharing;
class Media;  // lib/volume/medium.h

/// A material, light or camera that an animation changes in a segment (KHR_animation_pointer).
struct PropertyChange {
  std::string name, why;  ///< "Glass", "roughness of Glass"
  std::string carries;    ///< "material", "light" or "camera"
};

/// An interval of frames over which "static" means static (docs/methods/formulas.md). Both ends belong to it.
struct Segment {
  int first = 0, last = 0;
  std::vector<std::uint8_t> node_moves;  ///< per node: its evaluated state differs between two frames: its
                                         ///< world transform, the morph weights and joints of its mesh, its
                                         ///< materials or its light
  std::vector<std::string> why_moves;    ///< per node: "" or what differs, e.g. "translation of MovingBox"
  std::vector<PropertyChange> changes;   ///< materials, lights and cameras that differ between two frames
  Vec3d origin{};                        ///< world position of scene space's origin: 0 unless the scene
                                         ///< is far from the world's origin for its size
  Box3d world_bounds;                    ///< of all geometry over the whole segment, world space, m
};

struct TimeOptions {
  double fps = 24;                  ///< frame f is at time f / fps
  int segment_length = 24;          ///< frames; borders at multiples of it
  std::string light_units = "raw";  ///< raw, or spec: punctual lights divided by 683
};

/// `frame`, or the animation's nearest end if it lies outside: 0, or the frame of the last key (the next if
/// that lies between frames). Without animation every frame from 0 on is inside. What tools evaluate.
int frame_in_animation(const Scene& scene, int frame, const TimeOptions& options);

/// The segment that holds `frame`: [k length, (k+1) length - 1] cut to the frames of the animation
/// (cut at frame 0 and at the last frame of the scene's animation; one frame if nothing is animated is
/// still a segment of the full length).
Segment segment_of(const Scene& scene, int frame, const TimeOptions& options);

/// World transforms of all nodes at a frame. Frames outside the animation hold its first or last state.
std::vector<Affine> world_from_node(const Scene& scene, int frame, const TimeOptions& options);

/// An array that never changes, shared by its copies: static surfaces are the same memory in every frame.
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

/// Triangles of one primitive of one node, in scene space (world - Segment::origin). Cheap to copy.
///
/// A transform may flatten or shrink triangles to zero area at some frames: their normal is then zero, not
/// NaN, and they can neither be hit nor emit.
///
/// Where many nodes or instances share a large primitive, the surface is `instanced`: it keeps no vertices of
/// its own, position() and normal() transform the primitive's. They give the same numbers either way.
struct Surface {
  std::uint32_t object = 0;  ///< id.object
  std::uint32_t node = 0;
  std::uint32_t material = 0;
  bool flipped = false;                  ///< transform mirrors: the front is on the other winding
  const Primitive* primitive = nullptr;  ///< triangles and uvs; owned by the Scene
  SharedArray<Vec3> positions;           ///< scene space, m; double transform, rounded once; empty: instanced
  SharedArray<Vec3> normals;             ///< unit, or empty: flat shading, or instanced
  SharedArray<Vec3> tangents;            ///< only of a shape that deforms and has them; not unit
  Affine scene_from_node;                ///< of an instance: its own transform included

  bool instanced() const { return positions.empty(); }
  /// Scene space, m.
  Vec3 position(std::uint32_t vertex) const {
    return instanced() ? Vec3(scene_from_node.point(Vec3d(primitive->positions[vertex]))) : positions[vertex];
  }
  /// Has shading normals; else flat.
  bool smooth() const { return instanced() ? !primitive->normals.empty() : !normals.empty(); }
  /// Unit, scene space; only of a smooth surface.
  Vec3 normal(std::uint32_t vertex) const {
    return instanced() ? Vec3(normalize(scene_from_node.normal(Vec3d(primitive->normals[vertex])))) : normals[vertex];
  }
  /// Scene space, not unit; only of a primitive with tangents.
  Vec3 tangent(std::uint32_t vertex) const {
    return tangents.empty() ? Vec3(scene_from_node.direction(Vec3d(primitive->tangents[vertex]))) : tangents[vertex];
  }
};

struct PlacedLight {
  PunctualLight light;
  Vec3 position;   ///< scene space
  Vec3 direction;  ///< unit, the way it shines
  std::uint32_t node = 0;
};

struct PlacedCamera {
  Camera camera;
  Affine scene_from_camera;  ///< rigid: right, up, -forward in its columns; scale removed
};

/// What a stage depends on, hashed by concern; 32 hexadecimal digits each (formats/plan/plan.md).
struct SceneHashes {
  std::string camera;           ///< never part of an identity
  std::string static_geometry;  ///< of the segment
  std::string moving_geometry;  ///< at this frame
  std::string lights;           ///< punctual lights, which triangles emit what at this frame, environment
  std::string materials;
  std::string media;
};

/// The scene evaluated at a frame. Owns its surfaces; points into the Scene, which must outlive it.
struct SceneFrame {
  const Scene* scene = nullptr;
  int frame = 0;
  double time_s = 0;
  Segment segment;
  std::vector<Surface> surfaces;  ///< first the static ones, then those that move
  std::size_t static_count = 0;
  std::vector<Material> materials;              ///< evaluated
  std::shared_ptr<const TextureImages> images;  ///< of the materials' textures; null: there are none
  std::vector<PlacedLight> lights;
  const Environment* environment = nullptr;  ///< the scene's; nullptr: none
  std::shared_ptr<const Media> media;        ///< nullptr: none. at() leaves that; who reads the volumes sets it
  Vec3d origin{};                            ///< world = origin + scene space
  Box3 bounds;                               ///< of the whole segment, scene space
  std::vector<Affine> world_from_node;       ///< per node, at this frame
  std::vector<Camera> cameras;               ///< evaluated
  SceneHashes hashes;

  /// The camera of a node (an index into Scene::nodes, as Scene::camera_node returns it) at this frame.
  /// Throws InputError if the node's transform leaves it without a direction.
  PlacedCamera camera(int camera_node) const;
};

/// Content hash of one camera where it stands; SceneHashes::camera is over all cameras of the scene.
std::string camera_hash(const PlacedCamera& placed);

/// A scene over one segment: what is static in it is placed and hashed once, and shared by all its frames.
///
///     const SegmentScene stage(scene, segment_of(scene, 0, options), options);
///     for (int f = stage.segment().first; f <= stage.segment().last; ++f) use(stage.at(f));
///
/// at() is linear in what moves, not in what stands; safe to call from several threads. The Scene must
/// outlive it.
class SegmentScene {
 public:
  SegmentScene(const Scene& scene, Segment segment, const TimeOptions& options);

  const Segment& segment() const { return segment_; }
  /// Everything at `frame`, which the segment must hold (std::invalid_argument).
  /// Throws InputError if a transform takes geometry or a light beyond what can be computed with.
  SceneFrame at(int frame) const;

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

/// SegmentScene(scene, segment, options).at(frame), for callers that need one frame.
SceneFrame scene_at_frame(const Scene& scene, const Segment& segment, int frame, const TimeOptions& options);

}  // namespace tempolux
