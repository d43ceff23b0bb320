// lib/plan/plan.cpp -- compare the frames of each segment by content.
#include "lib/plan/plan.h"

#include <algorithm>
#include <array>
#include <iterator>
#include <map>
#include <set>
#include <stdexcept>
#include <utility>

#include "formats/error.h"
#include "formats/hash.h"
#include "lib/light/lights.h"
#include "lib/material/surface_material.h"
#include "lib/scene/animate.h"
#include "lib/scene/standing.h"

namespace tempolux {
namespace {

std::vector<MovingNode> moving_nodes(const Scene& scene, const Segment& segment) {
  std::vector<MovingNode> moves;
  for (std::size_t i = 0; i < scene.nodes.size(); ++i) {
    if (!segment.node_moves[i]) continue;
    const Node& node = scene.nodes[i];
    moves.push_back({node.name.empty() ? "node " + std::to_string(node.source_index) : node.name,
                     segment.why_moves[i],
                     node.mesh >= 0     ? "geometry"
                     : node.light >= 0  ? "light"
                     : node.camera >= 0 ? "camera"
                                        : ""});
  }
  for (const PropertyChange& change : segment.changes) moves.push_back({change.name, change.why, change.carries});
  return moves;
}

/// Whether anything but cameras moves, so that frames of the segment can differ in light.
bool light_transport_moves(const std::vector<MovingNode>& moves) {
  return std::ranges::any_of(moves, [](const MovingNode& node) {
    return node.carries == "geometry" || node.carries == "light" || node.carries == "material";
  });
}

/// The frames of a segment, evaluated, in order; of the frames asked for some may lie beyond the animation.
std::vector<PlannedFrame> planned_frames(const SegmentScene& stage, const Scene& scene,
                                         const std::set<int>& asked, int camera_node, bool light_moves,
                                         const TimeOptions& options, const MediaHash& media) {
  std::set<int> numbers = asked;
  for (int f = stage.segment().first; f <= stage.segment().last; ++f) numbers.insert(f);

  std::vector<PlannedFrame> frames;
  for (const int number : numbers) {
    PlannedFrame frame;
    frame.frame = number;
    frame.evaluated = frame_in_animation(scene, number, options);
    frame.asked = asked.contains(number);
    if (!frame.asked && !light_moves && !frames.empty()) {  // nothing to find out
      frame.moving_geometry = frames.front().moving_geometry;
      frame.lights = frames.front().lights;
      frame.materials = frames.front().materials;
    } else {
      const SceneFrame state = stage.at(frame.evaluated);
      frame.moving_geometry = state.hashes.moving_geometry;
      frame.lights = state.hashes.lights;
      frame.materials = state.hashes.materials;
      if (frame.asked) frame.camera = camera_hash(state.camera(camera_node));
    }
    if (media) frame.media = frame.evaluated != frame.frame && !frames.empty() && frames.back().evaluated == frame.evaluated
                                 ? frames.back().media : media(frame.evaluated);
    frames.push_back(std::move(frame));
  }
  return frames;
}

/// Sets lit_frame of all frames: the first frame of the same content, in whichever segment.
void share_light(std::vector<PlannedSegment>& segments) {
  std::map<std::array<std::string, 6>, int> first_with;
  const auto content = [](const PlannedSegment& s, const PlannedFrame& f) {
    return std::array{s.static_geometry, f.materials, s.frozen, f.moving_geometry, f.lights, f.media};
  };
  for (const PlannedSegment& segment : segments)
    for (const PlannedFrame& frame : segment.frames)
      if (frame.frame == frame.evaluated) first_with.try_emplace(content(segment, frame), frame.frame);
  for (PlannedSegment& segment : segments)
    for (PlannedFrame& frame : segment.frames) frame.lit_frame = first_with.at(content(segment, frame));
}

/// Sets picture of the frames asked for: those with equal light and camera show the same.
void share_pictures(std::vector<PlannedSegment>& segments) {
  std::map<std::pair<int, std::string>, int> first_with;
  for (PlannedSegment& segment : segments)
    for (PlannedFrame& frame : segment.frames)
      if (frame.asked)
        frame.picture = first_with.try_emplace({frame.lit_frame, frame.camera}, frame.frame).first->second;
}

/// The hash that all frames share, or one of them all.
std::string materials_of(const std::vector<PlannedFrame>& frames) {
  Hasher hasher;
  for (const PlannedFrame& frame : frames) hasher.add(std::string_view(frame.materials));
  const bool same = std::ranges::all_of(
      frames, [&](const PlannedFrame& frame) { return frame.materials == frames.front().materials; });
  return same ? frames.front().materials : hasher.hex();
}

bool cameras_differ(const std::vector<PlannedFrame>& frames) {
  std::set<std::string> hashes;
  for (const PlannedFrame& frame : frames)
    if (frame.asked) hashes.insert(frame.camera);
  return hashes.size() > 1;
}

/// The frames asked for, grouped by the segment that holds them.
std::vector<std::pair<Segment, std::set<int>>> by_segment(const Scene& scene, const std::vector<int>& frames,
                                                          const TimeOptions& options) {
  std::vector<std::pair<Segment, std::set<int>>> groups;
  for (const int frame : std::set<int>(frames.begin(), frames.end())) {
    const int evaluated = frame_in_animation(scene, frame, options);
    if (groups.empty() || evaluated > groups.back().first.last)
      groups.emplace_back(segment_of(scene, evaluated, options), std::set<int>{});
    groups.back().second.insert(frame);
  }
  return groups;
}

std::string standing_hash(const SceneFrame& frame) {
  const SceneHashes hashes = standing_scene(frame).hashes;
  Hasher hasher;
  for (const std::string& hash : {hashes.static_geometry, hashes.materials, hashes.lights}) hasher.add(std::string_view(hash));
  return hasher.hex();
}

PlannedSegment plan_segment(const Scene& scene, const Segment& segment, const std::set<int>& asked,
                            int camera_node, const TimeOptions& options, const MediaHash& media) {
  const SegmentScene stage(scene, segment, options);
  const SceneFrame begin = stage.at(segment.first);
  PlannedSegment planned;
  planned.first = segment.first;
  planned.last = segment.last;
  planned.static_geometry = begin.hashes.static_geometry;
  planned.standing = standing_hash(begin);
  planned.frozen = emission_hash(build_emission_table(scene, segment, options), segment);
  planned.moves = moving_nodes(scene, segment);
  const bool light_moves = light_transport_moves(planned.moves);
  planned.frames = planned_frames(stage, scene, asked, camera_node, light_moves, options, media);
  planned.materials = materials_of(planned.frames);
  planned.camera_moves = cameras_differ(planned.frames);
  return planned;
}

/// Materials that some triangle of the scene has.
std::set<std::uint32_t> used_materials(const Scene& scene) {
  std::set<std::uint32_t> used;
  for (const Node& node : scene.nodes)
    if (node.mesh >= 0)
      for (const Primitive& primitive : scene.meshes[std::size_t(node.mesh)].primitives)
        if (!primitive.triangles.empty()) used.insert(primitive.material);
  return used;
}

/// The materials at all frames of the plan; once if no animation changes them.
std::vector<std::vector<Material>> material_states(const Scene& scene, const Plan& plan) {
  const Animator animator(scene);
  if (animator.property_tracks().empty()) return {scene.materials};
  std::vector<std::vector<Material>> states;
  for (const PlannedSegment& segment : plan.segments)
    for (const PlannedFrame& frame : segment.frames)
      states.push_back(animator.materials(frame.evaluated / plan.time.fps));
  return states;
}

/// "1 frame", "3 frames".
std::string counted(std::size_t count, const std::string& what) {
  return std::to_string(count) + " " + what + (count == 1 ? "" : "s");
}

/// "12 of 14 materials reflect ...".
std::string share(std::size_t count, std::size_t of, const std::string& how) {
  const std::string verb = count == 1 ? " reflects " : " reflect ";
  return std::to_string(count) + " of " + counted(of, "material") + verb + how;
}

/// How many different values a member has in the frames asked for: states of light transport, pictures.
std::size_t different(const Plan& plan, int PlannedFrame::*member) {
  std::set<int> values;
  for (const PlannedSegment& segment : plan.segments)
    for (const PlannedFrame& frame : segment.frames)
      if (frame.asked) values.insert(frame.*member);
  return values.size();
}

/// Frames from one key to the next that warping needs between them at least; with fewer each picture is a key or beside two.
constexpr std::size_t kFewestForKeys = 4;

/// Are there pictures between key frames that warping could make? By what decides it. `other`: which materials mirror or shine, whose light
/// is traced in every frame all the same.
Stage plan_walkthrough(const Plan& plan, const std::string& other) {
  const std::size_t pictures = different(plan, &PlannedFrame::picture), states = different(plan, &PlannedFrame::lit_frame);
  const bool moves = std::ranges::any_of(plan.segments, &PlannedSegment::camera_moves) || pictures > states;
  if (pictures < kFewestForKeys) return {"ibr-warp", false, counted(pictures, "different picture") + ": too few to lie between keys"};
  if (!moves) return {"ibr-warp", false, "the camera stands: what is still costs little, and what moves must be traced"};
  if (states == pictures)
    return {"ibr-warp", false, "light transport differs in all " + counted(pictures, "picture") + ": keys lend little light to others"};
  return {"ibr-warp", true, "the camera moves through " + counted(pictures, "picture") + " of " + counted(states, "state") +
                                " of light transport; " + other};
}

/// The stages, and by which fact each is needed or not.
void plan_stages(const Scene& scene, Plan& plan) {
  const std::set<std::uint32_t> used = used_materials(scene);
  const std::vector<std::vector<Material>> at_frames = material_states(scene, plan);
  std::size_t diffuse = 0, specular = 0;
  for (const std::uint32_t material : used) {
    Lobes lobes;
    for (const std::vector<Material>& materials : at_frames) lobes |= lobes_of(materials[material]);
    diffuse += lobes.lambert;
    specular += lobes.specular;
  }
  const std::string lambert = share(diffuse, used.size(), "by a Lambert lobe");
  const std::string other = share(specular, used.size(), "by a mirror or glossy lobe");
  const std::string frames = counted(plan.frames.size(), "frame") + " asked for";
  const std::string states = counted(different(plan, &PlannedFrame::lit_frame), "state") + " of light transport";
  const std::string pictures = counted(different(plan, &PlannedFrame::picture), "different picture");

  const bool indirect = diffuse > 0, caustic = indirect && specular > 0;
  plan.photon_kinds = caustic ? "caustic,indirect" : indirect ? "indirect" : "";
  if (plan.media) plan.photon_kinds += plan.photon_kinds.empty() ? "volume" : ",volume";
  const bool photons = indirect || plan.media;
  plan.stages = {
      {"photon-trace", photons, photons ? frames + ", " + states : lambert},
      {"photon-trace --kinds indirect", indirect, lambert},
      {"photon-trace --kinds caustic", caustic, indirect ? other : lambert},
      {"photon-trace --kinds direct", false, "frame-render samples the lights for direct light"},
      {"irradcache-build points", indirect, indirect ? states : lambert},
      {"irradcache-build records", indirect, indirect ? states + ", " + pictures : lambert},
      plan_walkthrough(plan, other),
      {"frame-render", true, frames + ", " + pictures}};
  plan.walkthrough = plan.stages[plan.stages.size() - 2].needed;
  if (plan.media) plan.stages.push_back({"volume-compose", true, "there are media; " + pictures});
}

}  // namespace

void use_indirect(Plan& plan, const std::string& method, const std::string& because, bool caustic_map) {
  if (plan.photon_kinds.empty()) return;
  if (plan.media && method == "paths") throw InputError("indirect light by paths: the scene has media, which photons light; choose records or gather");
  plan.indirect = method;
  if (method == "paths") plan.photon_kinds = caustic_map ? "caustic" : "";
  for (Stage& stage : plan.stages) {
    const bool records = stage.name == "irradcache-build records";
    const bool left = caustic_map && (stage.name == "photon-trace" || stage.name == "photon-trace --kinds caustic");
    const bool before = !left && (stage.name.starts_with("photon-trace") || stage.name == "irradcache-build points");
    if (!stage.needed || !(records || before)) continue;
    if (records) stage.because += "; " + because;
    if (method == "paths" || (records && method == "gather")) stage = {stage.name, false, because};
  }
}

namespace {

/// States of light among what is asked for, by the segment that the first frame of each lies in.
std::map<std::size_t, std::set<int>> states_by_segment(const Plan& plan) {
  std::map<int, std::size_t> segment_of_frame;
  for (std::size_t i = 0; i < plan.segments.size(); ++i)
    for (const PlannedFrame& frame : plan.segments[i].frames) segment_of_frame.try_emplace(frame.frame, i);
  std::map<std::size_t, std::set<int>> states;
  for (const PlannedSegment& segment : plan.segments)
    for (const PlannedFrame& frame : segment.frames)
      if (frame.asked) states[segment_of_frame.at(frame.lit_frame)].insert(frame.lit_frame);
  std::erase_if(states, [](const auto& entry) { return entry.second.size() < kFewestStates; });
  return states;
}

}  // namespace

UpdatableLight updatable_light(const Plan& plan) {
  UpdatableLight light;
  std::size_t most = 0;
  for (const auto& [segment, states] : states_by_segment(plan)) {
    ++light.segments;
    light.states += states.size();
    if (states.size() <= most) continue;
    most = states.size();
    light.frame = *std::next(states.begin(), std::ptrdiff_t(most / 2));
  }
  return light;
}

void use_moving(Plan& plan, const std::string& method, const std::string& because) {
  if (plan.photon_kinds.empty() || plan.indirect == "paths") return;
  if (plan.media && method != "anew") throw InputError("light that follows from that of what stands: the scene has media, which all light meets; use anew");
  const auto states = states_by_segment(plan);
  const bool records = (method == "records" || method == "time") && plan.indirect == "records";
  plan.moving = method == "anew" || states.empty() ? "anew" : records ? method : "light";
  const bool light = plan.moving != "anew";
  for (const auto& entry : states) plan.segments[entry.first].updated = light;
  const auto before = std::ranges::find(plan.stages, "frame-render", &Stage::name);
  plan.stages.insert(before, {{"photon-trace --map dynamic", light, because},
                             {"irradcache-build records --update", plan.moving == "records", because},
                             {"gather-temporal final", plan.moving == "time", because}});
}

void use_split(Plan& plan, bool split, const std::string& because) {
  if (plan.photon_kinds.empty() || plan.indirect == "paths") return;
  const bool updated = plan.moving == "records";
  plan.split = split && !updated;
  const auto before = std::ranges::find(plan.stages, "irradcache-build records", &Stage::name);
  plan.stages.insert(before, {"photonmap-split", plan.split, split && updated ? "records follow from those of what stands" : because});
}

Plan make_plan(const Scene& scene, std::span<const int> frames, int camera_node, const TimeOptions& options,
               const MediaHash& media) {
  if (frames.empty()) throw std::invalid_argument("make_plan: no frames");
  require_lights(scene);
  Plan plan;
  const Node& camera = scene.nodes.at(std::size_t(camera_node));
  plan.camera = camera.name.empty() ? "node " + std::to_string(camera.source_index) : camera.name;
  if (scene.environment) plan.environment = scene.environment->path;
  plan.time = options;
  plan.media = bool(media);
  std::set<int> seen;
  for (const int frame : frames)
    if (seen.insert(frame).second) plan.frames.push_back(frame);

  std::size_t beyond = 0;
  for (const auto& [segment, asked] : by_segment(scene, plan.frames, options)) {
    plan.segments.push_back(plan_segment(scene, segment, asked, camera_node, options, media));
    for (const PlannedFrame& frame : plan.segments.back().frames) beyond += frame.frame != frame.evaluated;
  }
  share_light(plan.segments);
  share_pictures(plan.segments);
  if (beyond > 0)
    plan.warnings.push_back(counted(beyond, "frame") + " outside the animation: the nearest end is shown");
  plan_stages(scene, plan);
  return plan;
}

std::vector<ViewGroup> view_groups(const Plan& plan) {
  // By segment the first that it shares photons with: those a segment reads were traced in it or before it.
  std::vector<std::size_t> first_of(plan.segments.size());
  std::map<int, std::size_t> holder;   // of each frame at which photons may be traced: its segment
  for (std::size_t i = 0; i < plan.segments.size(); ++i) {
    first_of[i] = i;
    for (const PlannedFrame& frame : plan.segments[i].frames) holder.try_emplace(frame.frame, i);
  }
  const auto join = [&](std::size_t a, std::size_t b) {
    const std::size_t from = std::max(first_of[a], first_of[b]), to = std::min(first_of[a], first_of[b]);
    std::ranges::replace(first_of, from, to);
  };
  for (std::size_t i = 0; i < plan.segments.size(); ++i)
    for (const PlannedFrame& frame : plan.segments[i].frames) join(i, holder.at(frame.lit_frame));

  struct Members {
    std::set<int> photon_frames, pictures;
  };
  std::map<std::size_t, Members> groups;
  for (std::size_t i = 0; i < plan.segments.size(); ++i)
    for (const PlannedFrame& frame : plan.segments[i].frames)
      if (frame.asked) {
        groups[first_of[i]].photon_frames.insert(frame.lit_frame);
        groups[first_of[i]].pictures.insert(frame.picture);
      }
  std::vector<ViewGroup> list;
  for (const auto& [first, members] : groups)
    list.push_back({plan.segments[first].first,
                    {members.photon_frames.begin(), members.photon_frames.end()},
                    {members.pictures.begin(), members.pictures.end()}});
  return list;
}

}  // namespace tempolux
