// lib/scene/at_frame.h -- the scene at one frame: transforms evaluated, triangles in scene space.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "lib/scene/scene.h"

namespace tempolux {

/// An interval of frames over which "static" means static (architecture.md 4). Both ends belong to it.
struct Segment {
  int first = 0, last = 0;
  std::vector<std::uint8_t> node_moves;     ///< per node: its evaluated state differs between two frames
  std::vector<std::string> why_moves;       ///< per node: "" or what differs, e.g. "translation of MovingBox"
  Vec3d origin{};                           ///< world position of scene space's origin: 0 unless the scene
                                            ///< is far from the world's origin for its size
  Box3d world_bounds;                       ///< of all geometry over the whole segment, world space, m
};

struct TimeOptions {
  double fps = 24;                          ///< frame f is at time f / fps
  int segment_length = 24;                  ///< frames; borders at multiples of it
  std::string light_units = "raw";          ///< raw, or spec: punctual lights divided by 683
};

/// The segment that holds `frame`: [k length, (k+1) length - 1] cut to the frames of the animation
/// (cut at frame 0 and at the last frame of the scene's animation; one frame if nothing is animated is
/// still a segment of the full length).
Segment segment_of(const Scene& scene, int frame, const TimeOptions& options);

/// World transforms of all nodes at a frame. Frames outside the animation hold its first or last state.
std::vector<Affine> world_from_node(const Scene& scene, int frame, const TimeOptions& options);

/// Triangles of one primitive of one node, in scene space (world - Segment::origin).
struct Surface {
  std::uint32_t object = 0;                 ///< id.object
  std::uint32_t node = 0;
  std::uint32_t material = 0;
  bool flipped = false;                     ///< transform mirrors: the front is on the other winding
  const Primitive* primitive = nullptr;     ///< triangles and uvs; owned by the Scene
  std::vector<Vec3> positions;              ///< scene space, m
  std::vector<Vec3> normals;                ///< unit, or empty
  Affine scene_from_node;
};

struct PlacedLight {
  PunctualLight light;
  Vec3 position;                            ///< scene space
  Vec3 direction;                           ///< unit, the way it shines
  std::uint32_t node = 0;
};

struct PlacedCamera {
  Camera camera;
  Affine scene_from_camera;                 ///< rigid: right, up, -forward in its columns; scale removed
};

/// What a stage depends on, hashed by concern; 32 hexadecimal digits each (architecture.md 3 and 4).
struct SceneHashes {
  std::string camera;                       ///< never part of an identity
  std::string static_geometry;              ///< of the segment
  std::string moving_geometry;              ///< at this frame
  std::string lights;                       ///< punctual lights and which triangles emit what, at this frame
  std::string materials;
  std::string media;
};

/// The scene evaluated at a frame. Owns its surfaces; points into the Scene, which must outlive it.
struct SceneFrame {
  const Scene* scene = nullptr;
  int frame = 0;
  double time_s = 0;
  Segment segment;
  std::vector<Surface> surfaces;            ///< first the static ones, then those that move
  std::size_t static_count = 0;
  std::vector<Material> materials;          ///< evaluated
  std::vector<PlacedLight> lights;
  Vec3d origin{};                           ///< world = origin + scene space
  Box3 bounds;                              ///< of the whole segment, scene space
  SceneHashes hashes;

  PlacedCamera camera(int camera_node) const;
};

/// Evaluates everything at `frame`. `segment` must hold the frame.
SceneFrame scene_at_frame(const Scene& scene, const Segment& segment, int frame, const TimeOptions& options);

}  // namespace tempolux
