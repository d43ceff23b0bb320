// lib/plan/plan.h -- what a range of frames needs, and which frames can share it (architecture.md 4 and 8).
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "lib/scene/at_frame.h"

namespace tempolux {

/// What moves in a segment: a node, or a material, light or camera that an animation changes.
struct MovingNode {
  std::string name;                 ///< its name in the scene, or "node N"
  std::string why;                  ///< what differs: "translation of MovingBox"
  std::string carries;              ///< "geometry", "light", "camera", "material", or "" (only its children matter)
};

/// What is known of one frame. Frames with equal `lit_frame` have the same light transport.
struct PlannedFrame {
  int frame = 0;                    ///< its number, as asked for
  bool asked = false;               ///< in the range of the plan; the others only complete their segment
  int evaluated = 0;                ///< whose state it shows: `frame`, or the animation's nearest end
  int lit_frame = 0;                ///< first frame of the plan's segments with the same light transport
  int picture = 0;                  ///< if asked: first frame asked for with the same light transport and camera
  std::string camera;               ///< hash of the chosen camera; empty if not asked
  std::string moving_geometry;      ///< hashes, as in SceneHashes
  std::string lights;
  std::string materials;
  std::string media;                ///< empty: the scene has no media at any frame
};

/// A segment that holds some of the frames asked for, with all frames it has.
struct PlannedSegment {
  int first = 0, last = 0;
  std::string static_geometry;      ///< hash, as in SceneHashes
  std::string materials;            ///< the same; if an animation changes materials, of all frames' hashes
  std::string standing;             ///< hash of what neither moves nor changes: geometry, materials, lights (standing_scene)
  std::string frozen;               ///< hash of what is frozen: emission table, bounds, origin
  bool updated = false;             ///< light of its frames follows from that of what stands (Plan::moving)
  bool camera_moves = false;        ///< the camera differs between two of the frames asked for
  std::vector<MovingNode> moves;
  std::vector<PlannedFrame> frames; ///< all of the segment, in order; those beyond the animation after them
};

/// Whether a stage of the pipeline has work, and the fact that decides it.
struct Stage {
  std::string name;
  bool needed = false;
  std::string because;
};

/// Segments whose frames share photons, directly or by others between them.
struct ViewGroup {
  int first = 0;                    ///< first frame of the first of the segments
  std::vector<int> photon_frames;   ///< where photons are traced for what is asked for, ascending
  std::vector<int> pictures;        ///< different pictures that they light, ascending
};

/// Where the cameras of a group look: a file of state/ for its photons.
struct PlannedView {
  int first = 0;                    ///< of the group
  std::vector<int> photon_frames;
  std::string content;              ///< formats/plan/view.h
};

struct Plan {
  std::string camera;               ///< name of the camera's node
  std::string environment;          ///< file of the light around the scene, or its option; "": none
  TimeOptions time;
  std::vector<int> frames;          ///< those asked for, in the order asked, each once
  std::vector<PlannedSegment> segments;  ///< by first frame
  std::vector<Stage> stages;
  bool walkthrough = false;         ///< key frames and warping pay: METHOD=auto follows it
  std::string photon_kinds;         ///< what photon-trace has to record: "caustic,indirect"; "" if no photons
  /// How indirect light is found: "records", "gather" (in the pixel) or "paths". The last two leave out stages.
  std::string indirect = "records";
  std::uint64_t photon_paths = 700'000;   ///< of a photon map, photon-trace --photons
  int record_rays = 500;            ///< gather rays of a record, irradcache-build records --rays
  /// What of each state of light follows from that of what stands: "anew" (nothing), "light" (photons and points), "records" (they,
  /// too) or "time" (photons and points; records from those of the state before in the segment).
  std::string moving = "anew";
  bool learn_lights = true;         ///< light from far away comes through openings: frame-render is to learn which way
  bool split = false;               ///< bright points are divided from the others and sampled explicitly
  bool media = false;               ///< has the scene media?
  std::vector<PlannedView> views;   ///< empty: photons are not aimed. make_plan leaves it so, it traces no rays
  std::vector<std::string> warnings;
};

/// Leaves out what another way of finding indirect light does not need: records, or photons and points as well.
/// `because`: the fact that decides. A plan whose scene has no indirect light stays as it is. Throws InputError for paths where
/// there are media: their light is photons'. `caustic_map`: with paths, photons tell caustic light all the same.
void use_indirect(Plan& plan, const std::string& method, const std::string& because, bool caustic_map = false);

/// Segments of whose light something stands while something moves: those with kFewestStates states of light or more among what is
/// asked for.
struct UpdatableLight {
  std::size_t segments = 0, states = 0;   ///< such segments, and the states of light in them
  int frame = 0;                          ///< the middle state of the segment that has most
};
inline constexpr std::size_t kFewestStates = 3;
UpdatableLight updatable_light(const Plan& plan);

/// Has the light of such segments follow from that of what stands, as far as `method` says (Plan::moving). `because`: the fact that
/// decides.
void use_moving(Plan& plan, const std::string& method, const std::string& because);
/// Has points divided where `split` says so and it can be: points are read, by records made anew or in pixels; not by records that follow
/// from those of what stands. `because`: the fact that decides.
void use_split(Plan& plan, bool split, const std::string& because);
/// The media at a frame: content hash (SceneHashes::media). An empty function: there are none.
using MediaHash = std::function<std::string(int frame)>;

/// Evaluates the segments that hold `frames` and compares their states by content: hashes decide, neither
/// file times nor what the file calls an animation. A frame beyond the animation shows its nearest end and is
/// warned about.
///
/// `camera_node` is an index into Scene::nodes (Scene::camera_node). Time is linear in what moves, times the
/// frames of the segments, and in what stands, times the segments. Throws InputError for a scene without
/// light or one that cannot be evaluated, std::invalid_argument for an empty `frames`.
Plan make_plan(const Scene& scene, std::span<const int> frames, int camera_node, const TimeOptions& options,
               const MediaHash& media = {});

/// By first frame. Photons of one group are aimed alike, so that photon i is the same in all of its frames.
std::vector<ViewGroup> view_groups(const Plan& plan);

}  // namespace tempolux
