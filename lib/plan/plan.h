// lib/plan/plan.h -- the scene's states in the segments that a range of frames needs (docs/methods/formulas.md).
//
// Every value depends on the scene and the segment only, never on which other frames were requested.
#pragma once

#include <array>
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

/// Something that moves in a segment: a node, or a material, light or camera that an animation changes.
struct MovingNode {
  std::string name;     ///< its name in the scene, or "node N"
  std::string why;      ///< the difference, such as "translation of MovingBox"
  std::string carries;  ///< "geometry", "light", "camera", "material", or "" (only its children matter)
};

/// One frame of a segment, inside the animation. Hashes are as in SceneHashes.
struct PlannedFrame {
  int frame = 0;
  int lit_frame = 0;                 ///< first frame of the segment with the same light transport
  int picture = 0;                   ///< first frame of the segment with the same light transport and camera
  int viewed = 0;                    ///< first frame of the segment with the same light transport and pinhole camera
  std::optional<PlacedCamera> view;  ///< scene space; empty: the camera has no direction
  std::string pinhole;               ///< pinhole_hash() of the camera
  std::string camera, moving_geometry, lights, materials;
  std::string media;  ///< empty: the scene has no media
  std::string light;  ///< hash of everything that light transport depends on at this frame
};

struct PlannedSegment {
  int first = 0, last = 0;
  std::string static_geometry;  ///< hash, as in SceneHashes
  std::string static_scene;     ///< hash of the static scene: geometry, materials, lights (static_scene_of)
  std::string frozen;           ///< hash of everything that is fixed over the segment: emission table, bounds, origin
  std::vector<MovingNode> moves;
  std::vector<PlannedFrame> frames;  ///< all frames of the segment, ascending
  bool only_pixels = false;          ///< true: no frame of it was asked for, it holds the middle frame (make_plan)
  MaterialFacts materials;           ///< lobes of the materials, over all frames
  Decisions decisions;

  bool holds(int frame) const { return first <= frame && frame <= last; }
  const PlannedFrame& at(int frame) const;
  /// First frame of each state of light transport, ascending.
  std::vector<int> states() const;
  /// First frame of each different picture, ascending; with `lit` only pictures in that state of light.
  std::vector<int> pictures(std::optional<int> lit = {}) const;
  /// The same for PlannedFrame::viewed: records and points that serve a picture do not depend on the camera's lens.
  std::vector<int> views(std::optional<int> lit = {}) const;
  /// True if the camera's lens or shutter blurs some frame.
  bool is_blurred() const;
};

struct Plan {
  std::string camera;       ///< name of the camera's node
  std::string environment;  ///< file or option of the environment; "": none
  TimeOptions time;
  std::vector<int> frames;   ///< the frames asked for, in that order, each once
  std::map<int, int> shows;  ///< for each frame asked for: the frame itself, or the closest frame of the animation
  /// Last frame at which anything changes; with media, last frame of the animation, without one a very large number.
  int last_frame = 0;
  std::vector<PlannedSegment> segments;  ///< by first frame
  /// First and last frame of the shot: those of the animation, or what was asked for.
  std::array<int, 2> shot_frames{};
  /// The segments that stand for the shot: the segments that hold the shot's first, middle and last frame, each once.
  /// Decisions of the shot follow from these segments. Empty in scenes with media, whose files need not exist at all
  /// frames of the animation.
  std::vector<PlannedSegment> shot;
  bool media = false;  ///< true if the scene has media
  std::string names;   ///< hash of the names of objects and materials, which mattes show
  std::vector<std::string> warnings;

  /// The frame in the middle of the shot, if its segment is in the plan (make_plan).
  std::optional<int> middle() const;
  int middle_of_shot() const { return shot_frames[0] + (shot_frames[1] - shot_frames[0]) / 2; }
  /// The segment that holds a frame of the animation. Throws std::out_of_range if it is not in the plan.
  const PlannedSegment& segment_of(int frame) const;
};

/// What is asked of the shot.
struct ShotWish {
  /// First and last frame; without: those of the animation. Both are clamped to the animation. The frames asked for may
  /// lie outside of the shot: decisions of the shot and kept pixels come from its frames.
  std::optional<std::array<int, 2>> frames;
  /// The plan gets the segment of the shot's middle frame as well, if the camera of the middle frame is that of another
  /// frame.
  bool with_middle = false;
};

/// Hash of the media at a frame (SceneHashes::media). Empty: there are no media.
using MediaHash = std::function<std::string(int frame)>;

/// Evaluates the segments that hold `frames` and `others`, and compares their frames by content hashes. Neither file
/// times nor the file's declarations of what is animated count. `others` are frames that the requested frames need:
/// neighbours and keys. A requested frame outside the animation shows the animation's closest frame, with a warning.
/// Decisions keep their defaults.
///
/// `camera_node` is an index into Scene::nodes (Scene::camera_node). Throws InputError for a scene without light and
/// for a scene that cannot be evaluated, std::invalid_argument for an empty `frames`.
Plan make_plan(const Scene& scene, std::span<const int> frames, int camera_node, const TimeOptions& options,
               const MediaHash& media = {}, std::span<const int> others = {}, const ShotWish& shot = {});

}  // namespace tempolux
