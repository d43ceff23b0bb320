// lib/plan/plan.h -- the states of a scene in the segments that a range of frames needs (docs/methods/formulas.md).
//
// Everything here follows from the scene and the segment. No value depends on which other frames were asked for.
#pragma once

#include <functional>
#include <map>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <vector>

#include "lib/plan/decisions.h"
#include "lib/scene/at_frame.h"

namespace tempolux {

/// What moves in a segment: a node, or a material, light or camera that an animation changes.
struct MovingNode {
  std::string name;     ///< its name in the scene, or "node N"
  std::string why;      ///< what differs: "translation of MovingBox"
  std::string carries;  ///< "geometry", "light", "camera", "material", or "" (only its children matter)
};

/// One frame of a segment, inside the animation. Hashes are those of SceneHashes.
struct PlannedFrame {
  int frame = 0;
  int lit_frame = 0;                 ///< first frame of the segment with the same light transport
  int picture = 0;                   ///< first frame of the segment with the same light transport and camera
  std::optional<PlacedCamera> view;  ///< scene space; none: it has no direction
  std::string camera, moving_geometry, lights, materials;
  std::string media;  ///< empty: the scene has no media
  std::string light;  ///< hash of all that light transport depends on at this frame
};

struct PlannedSegment {
  int first = 0, last = 0;
  std::string static_geometry;  ///< hash, as in SceneHashes
  std::string standing;  ///< hash of what neither moves nor changes: geometry, materials, lights (standing_scene)
  std::string frozen;    ///< hash of what is frozen: emission table, bounds, origin
  std::vector<MovingNode> moves;
  std::vector<PlannedFrame> frames;  ///< all of the segment, ascending, each once
  MaterialFacts materials;           ///< how the materials reflect, over all of its frames
  Decisions decisions;

  const PlannedFrame& at(int frame) const;
  /// First frames of its states of light transport, ascending.
  std::vector<int> states() const;
  /// First frames of its different pictures, ascending; with `lit`, of those that this state lights.
  std::vector<int> pictures() const;
  std::vector<int> pictures(int lit) const;
};

struct Plan {
  std::string camera;       ///< name of the camera's node
  std::string environment;  ///< file of the light around the scene, or its option; "": none
  TimeOptions time;
  std::vector<int> frames;               ///< those asked for, in the order asked, each once
  std::map<int, int> shows;              ///< of each frame asked for: itself, or the animation's nearest end
  int last_frame = 0;                    ///< of the animation; beyond it nothing changes. Large if nothing is animated
  std::vector<PlannedSegment> segments;  ///< by first frame
  bool media = false;                    ///< has the scene media?
  std::vector<std::string> warnings;

  /// The segment that holds a frame inside the animation. std::out_of_range if it is not in the plan.
  const PlannedSegment& segment_of(int frame) const;
  bool has(int frame) const;
};

/// The media at a frame: content hash (SceneHashes::media). An empty function: there are none.
using MediaHash = std::function<std::string(int frame)>;

/// Evaluates the segments that hold `frames` and `others` and compares their states by content: hashes decide, neither
/// file times nor what the file calls an animation. `others` are frames that the frames asked for need: neighbours,
/// keys. Frames outside the animation show its nearest end and are warned about. Decisions are left as they are by
/// default.
///
/// `camera_node` is an index into Scene::nodes (Scene::camera_node). Throws InputError for a scene without light or one
/// that cannot be evaluated, std::invalid_argument for an empty `frames`.
Plan make_plan(const Scene& scene, std::span<const int> frames, int camera_node, const TimeOptions& options,
               const MediaHash& media = {}, std::span<const int> others = {});

}  // namespace tempolux
