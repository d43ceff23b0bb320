// lib/plan/plan.cpp -- compares the frames of each segment by content.
#include "lib/plan/plan.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <limits>
#include <map>
#include <set>
#include <span>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "formats/error.h"
#include "formats/hash.h"
#include "lib/light/lights.h"
#include "lib/material/surface_material.h"
#include "lib/scene/animate.h"
#include "lib/scene/camera_properties.h"
#include "lib/scene/segment_between.h"
#include "lib/scene/shutter_times.h"
#include "lib/scene/static_scene.h"

namespace tempolux {
namespace {

std::vector<MovingNode> moving_nodes(const Scene& scene, const Segment& segment) {
  std::vector<MovingNode> moves;
  for (std::size_t i = 0; i < scene.nodes.size(); ++i) {
    if (!segment.node_moves[i]) continue;
    const Node& node = scene.nodes[i];
    moves.push_back({node.name.empty() ? "node " + std::to_string(node.source_index) : node.name, segment.why_moves[i],
                     node.mesh >= 0     ? "geometry"
                     : node.light >= 0  ? "light"
                     : node.camera >= 0 ? "camera"
                                        : ""});
  }
  for (const PropertyChange& change : segment.changes) moves.push_back({change.name, change.why, change.carries});
  return moves;
}

/// The longest time that the camera's shutter is open, frames.
double longest_shutter(const CameraExtras& extras) {
  double longest = 0;
  for (std::size_t row = 0; row < extras.lists.size(); ++row)
    if (camera_properties()[row].member == decltype(CameraProperty::member)(&Camera::shutter_frames))
      for (const double frames : extras.lists[row]) longest = std::max(longest, frames);
  return longest;
}

/// Hash of what the camera sees while its shutter is open: the scene's states at five times. "" if all are equal: then
/// nothing is blurred. A frame at rest and one at which something stops are different pictures, although both show one
/// state.
std::string shutter_hash(const SceneFrame& state, const ShutterTimes& times, int camera_node) {
  if (!(times.length > 0)) return "";
  constexpr int kStates = 5;
  const Scene& scene = *state.scene;
  const Segment segment = segment_between(scene, times.first_step(), times.last_step(), times.options);
  const auto moves = [](std::uint8_t moved) { return moved != 0; };
  if (segment.changes.empty() && std::ranges::none_of(segment.node_moves, moves)) return "";
  const SegmentScene stage(scene, segment, times.options);
  std::vector<std::string> states;
  for (int i = 0; i < kStates; ++i) {
    SceneFrame at = stage.at(times.step(double(i) / (kStates - 1)));
    at.frame = state.frame;
    states.push_back(hash_of_texts(
        {at.hashes.moving_geometry, at.hashes.lights, at.hashes.materials, pinhole_hash(at.camera(camera_node))}));
  }
  if (std::ranges::all_of(states, [&](const std::string& one) { return one == states.front(); })) return "";
  Hasher hasher;
  for (const std::string& one : states) hasher.add(std::string_view(one));
  return hasher.hex();
}

PlannedFrame planned_frame(const SceneFrame& state, int number, int camera_node, const MediaHash& media,
                           const TimeOptions& time) {
  PlannedFrame frame;
  frame.frame = number;
  frame.moving_geometry = state.hashes.moving_geometry;
  frame.lights = state.hashes.lights;
  frame.materials = state.hashes.materials;
  try {
    frame.view = state.camera(camera_node);
    frame.camera = camera_hash(*frame.view);
    frame.pinhole = pinhole_hash(*frame.view);
    const std::string blur = shutter_hash(state, ShutterTimes(frame.view->camera, state.frame, time), camera_node);
    if (!blur.empty()) frame.camera = hash_of_texts({frame.camera, blur});
  } catch (const InputError&) {  // The camera has no direction. The tools report it if this frame is requested.
  }
  if (media) frame.media = media(number);
  return frame;
}

/// All frames of the segment. If nothing moves, only the first frame is evaluated.
std::vector<PlannedFrame> planned_frames(const SegmentScene& stage, int camera_node, bool anything_moves,
                                         const MediaHash& media, const TimeOptions& time) {
  std::vector<PlannedFrame> frames;
  for (int f = stage.segment().first; f <= stage.segment().last; ++f) {
    if (anything_moves || frames.empty()) {
      frames.push_back(planned_frame(stage.at(f), f, camera_node, media, time));
    } else {
      frames.push_back(frames.front());
      frames.back().frame = f;
      if (media) frames.back().media = media(f);
    }
  }
  return frames;
}

/// Sets light, lit_frame and picture of all frames.
void share_in_segment(PlannedSegment& segment) {
  std::map<std::string, int> first_lit;
  std::map<std::pair<int, std::string>, int> first_picture, first_view;
  for (PlannedFrame& frame : segment.frames) {
    frame.light = hash_of_texts(
        {segment.static_geometry, frame.materials, segment.frozen, frame.moving_geometry, frame.lights, frame.media});
    frame.lit_frame = first_lit.try_emplace(frame.light, frame.frame).first->second;
    frame.picture = first_picture.try_emplace({frame.lit_frame, frame.camera}, frame.frame).first->second;
    frame.viewed = first_view.try_emplace({frame.lit_frame, frame.pinhole}, frame.frame).first->second;
  }
}

/// The last frame at which the lists of a camera's lens may change; 0 if the lists do not change.
int last_of_lens(const Node& camera) {
  if (!camera.camera_extras.changes()) return 0;
  const auto longest = std::ranges::max_element(camera.camera_extras.lists, {}, &std::vector<double>::size);
  return camera.camera_extras.first_frame + int(longest->size()) - 1;
}

std::string static_scene_hash(const SceneFrame& frame) {
  const SceneHashes hashes = static_scene_of(frame).hashes;
  return hash_of_texts({hashes.static_geometry, hashes.materials, hashes.lights});
}

/// The frames as text, in the given order, with ranges of consecutive frames: "-2, 48 to 60".
std::string in_words(std::span<const int> frames) {
  std::string words;
  for (std::size_t i = 0; i < frames.size();) {
    std::size_t end = i + 1;
    while (end < frames.size() && frames[end] == frames[end - 1] + 1) ++end;
    words += (words.empty() ? "" : ", ") + std::to_string(frames[i]);
    if (end > i + 1) words += " to " + std::to_string(frames[end - 1]);
    i = end;
  }
  return words;
}

/// First and last frame of the animation: "0 to 47"; "0 and later" without animation.
std::string extent_in_words(const Scene& scene, const TimeOptions& options) {
  const int last = frame_in_animation(scene, std::numeric_limits<int>::max(), options);
  return last == std::numeric_limits<int>::max() ? "0 and later" : "0 to " + std::to_string(last);
}

/// The lobes of the materials of all triangles, at all frames of the segment.
MaterialFacts material_facts(const Scene& scene, const PlannedSegment& segment, const TimeOptions& options) {
  const Animator animator(scene);
  MaterialFacts facts;
  for (const PlannedFrame& frame : segment.frames) {
    const std::vector<Material> materials = animator.materials(frame.frame / options.fps);
    for (const Node& node : scene.nodes) {
      if (node.mesh < 0) continue;
      for (const Primitive& primitive : scene.meshes[std::size_t(node.mesh)].primitives) {
        const Lobes lobes = lobes_of(materials[primitive.material]);
        facts.lambert |= lobes.lambert && !primitive.triangles.empty();
        facts.other |= lobes.specular && !primitive.triangles.empty();
      }
    }
    if (animator.property_tracks().empty()) break;  // No animation changes materials.
  }
  return facts;
}

PlannedSegment plan_segment(const Scene& scene, const Segment& segment, int camera_node, const TimeOptions& options,
                            const MediaHash& media) {
  const SegmentScene stage(scene, segment, options);
  const SceneFrame begin = stage.at(segment.first);
  PlannedSegment planned;
  planned.first = segment.first;
  planned.last = segment.last;
  planned.static_geometry = begin.hashes.static_geometry;
  planned.static_scene = static_scene_hash(begin);
  planned.frozen = emission_hash(build_emission_table(scene, segment, options), segment);
  planned.moves = moving_nodes(scene, segment);
  const CameraExtras& extras = scene.nodes.at(std::size_t(camera_node)).camera_extras;
  const bool moves = !planned.moves.empty() || extras.changes() || extras.focus_node >= 0 ||
                     (longest_shutter(extras) > 0 && !scene.animations.empty());
  planned.frames = planned_frames(stage, camera_node, moves, media, options);
  share_in_segment(planned);
  planned.materials = material_facts(scene, planned, options);
  return planned;
}

/// The first frame after which no track changes: the time of the last key whose value differs from the key before,
/// rounded up to a frame. 0 if nothing changes.
int last_change(const Scene& scene, const TimeOptions& options) {
  double last_s = 0;
  for (const Animation& animation : scene.animations)
    for (const AnimationTrack& track : animation.tracks) {
      const std::size_t n = track.times_s.size(), per_key = n == 0 ? 0 : track.values.size() / n;
      for (std::size_t key = n; key-- > 1;)  // The values of splines include tangents.
        if (!std::equal(track.values.begin() + std::ptrdiff_t(key * per_key),
                        track.values.begin() + std::ptrdiff_t((key + 1) * per_key),
                        track.values.begin() + std::ptrdiff_t((key - 1) * per_key))) {
          last_s = std::max(last_s, track.times_s[key]);
          break;
        }
    }
  return std::min(frame_in_animation(scene, int(std::ceil(std::min(last_s * options.fps, 1e9) - 1e-3)), options),
                  1'000'000'000);
}

/// Returns the segments that hold the first, the middle and the last frame of the shot. Each segment appears once.
std::vector<PlannedSegment> pieces_of_shot(const Scene& scene, const Plan& plan, int camera_node,
                                           const MediaHash& media) {
  std::vector<PlannedSegment> pieces;
  if (media) return pieces;
  for (const int frame : {plan.shot_frames[0], plan.middle_of_shot(), plan.shot_frames[1]}) {
    if (!pieces.empty() && frame <= pieces.back().last) continue;
    const auto known = std::ranges::find_if(plan.segments, [&](const PlannedSegment& s) { return s.holds(frame); });
    pieces.push_back(known != plan.segments.end()
                         ? *known
                         : plan_segment(scene, segment_of(scene, frame, plan.time), camera_node, plan.time, media));
  }
  return pieces;
}

/// Adds the segment of the shot's middle frame, if its camera is that of a frame in the plan.
void add_middle(Plan& plan) {
  const int middle = plan.middle_of_shot();
  const auto holds = [&](const PlannedSegment& segment) { return segment.holds(middle); };
  const auto piece = std::ranges::find_if(plan.shot, holds);
  if (piece == plan.shot.end() || std::ranges::any_of(plan.segments, holds)) return;
  const std::string& camera = piece->at(middle).camera;
  const bool seen = std::ranges::any_of(plan.segments, [&](const PlannedSegment& segment) {
    return std::ranges::find(segment.frames, camera, &PlannedFrame::camera) != segment.frames.end();
  });
  if (!seen) return;
  const auto place = std::ranges::lower_bound(plan.segments, middle, {}, &PlannedSegment::first);
  plan.segments.insert(place, *piece)->only_pixels = true;
}

/// The different values of a member, ascending; with `lit` only in that state of light.
std::vector<int> values_of(const PlannedSegment& segment, int PlannedFrame::*member, std::optional<int> lit) {
  std::set<int> values;
  for (const PlannedFrame& frame : segment.frames)
    if (!lit || frame.lit_frame == *lit) values.insert(frame.*member);
  return {values.begin(), values.end()};
}

}  // namespace

const PlannedFrame& PlannedSegment::at(int frame) const { return frames.at(std::size_t(frame - first)); }

std::vector<int> PlannedSegment::states() const { return values_of(*this, &PlannedFrame::lit_frame, {}); }

std::vector<int> PlannedSegment::pictures(std::optional<int> lit) const {
  return values_of(*this, &PlannedFrame::picture, lit);
}

std::vector<int> PlannedSegment::views(std::optional<int> lit) const {
  return values_of(*this, &PlannedFrame::viewed, lit);
}

bool PlannedSegment::is_blurred() const {
  return std::ranges::any_of(frames, [](const PlannedFrame& frame) {
    return frame.view && (frame.view->camera.has_lens() || frame.view->camera.shutter_frames > 0);
  });
}

std::optional<int> Plan::middle() const {
  const auto holds = [&](const PlannedSegment& segment) { return segment.holds(middle_of_shot()); };
  return std::ranges::any_of(segments, holds) ? std::optional(middle_of_shot()) : std::nullopt;
}

const PlannedSegment& Plan::segment_of(int frame) const {
  const auto after = std::ranges::upper_bound(segments, frame, {}, &PlannedSegment::first);
  if (after == segments.begin() || std::prev(after)->last < frame)
    throw std::out_of_range("Plan::segment_of: frame " + std::to_string(frame));
  return *std::prev(after);
}

Plan make_plan(const Scene& scene, std::span<const int> frames, int camera_node, const TimeOptions& options,
               const MediaHash& media, std::span<const int> others, const ShotWish& shot) {
  if (frames.empty()) throw std::invalid_argument("make_plan: no frames");
  require_lights(scene);
  Plan plan;
  const Node& camera = scene.nodes.at(std::size_t(camera_node));
  plan.camera = camera.name.empty() ? "node " + std::to_string(camera.source_index) : camera.name;
  if (scene.environment) plan.environment = scene.environment->path;
  plan.time = options;
  plan.media = bool(media);
  Hasher names;
  for (const std::string& name : scene.object_names) names.add(std::string_view(name));
  for (const Material& material : scene.materials) names.add(std::string_view(material.name));
  plan.names = names.hex();
  const int last = frame_in_animation(scene, std::numeric_limits<int>::max(), options);
  plan.last_frame =
      media
          ? last
          : std::min(last, std::max(last_change(scene, options) + int(std::ceil(longest_shutter(camera.camera_extras))),
                                    last_of_lens(camera)));

  plan.shot_frames = {0, plan.last_frame};
  if (shot.frames)
    for (const std::size_t end : {0, 1}) plan.shot_frames[end] = std::clamp((*shot.frames)[end], 0, plan.last_frame);

  std::vector<int> outside;
  std::set<int> needed;
  for (const int frame : frames) {
    const int shown = std::clamp(frame, 0, plan.last_frame);
    if (!plan.shows.try_emplace(frame, shown).second) continue;
    plan.frames.push_back(frame);
    if (frame_in_animation(scene, frame, options) != frame) outside.push_back(frame);
    needed.insert(shown);
  }
  for (const int frame : others) needed.insert(std::clamp(frame, 0, plan.last_frame));
  for (const int frame : needed)
    if (plan.segments.empty() || frame > plan.segments.back().last)
      plan.segments.push_back(plan_segment(scene, segment_of(scene, frame, options), camera_node, options, media));
  plan.shot = pieces_of_shot(scene, plan, camera_node, media);
  if (shot.with_middle) add_middle(plan);
  if (!outside.empty())
    plan.warnings.push_back("of the frames asked for " + in_words(outside) + (outside.size() == 1 ? " is" : " are") +
                            " outside the animation (" + extent_in_words(scene, options) +
                            "): its nearest end is shown");
  return plan;
}

}  // namespace tempolux
