// lib/scene/segment.cpp -- computes segments: their frames, their movers, and the origin of scene space.
#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>

#include "formats/error.h"
#include "lib/core/box_corners.h"
#include "lib/scene/animate.h"
#include "lib/scene/at_frame.h"
#include "lib/scene/deform.h"
#include "lib/scene/place_surfaces.h"
#include "lib/scene/material_properties.h"
#include "lib/scene/segment_between.h"

namespace tempolux {
namespace {

using Path = AnimationTrack::Path;

/// Scene space gets its own origin if the scene is farther from the world's origin than this many times its diagonal:
/// coordinates in world space would then lose 6 of float32's 24 bits.
constexpr double kFarRatio = 64;

int floor_to_multiple(int value, int step) {
  const int remainder = value % step;
  return value - (remainder < 0 ? remainder + step : remainder);
}

/// The first frame from which on nothing moves: the frame of the last key, rounded up.
int last_frame(const Scene& scene, const TimeOptions& options) {
  const double frame = std::ceil(scene.duration_s * options.fps - 1e-3);
  return frame < 1e9 ? int(frame) : 1'000'000'000;
}

void set_borders(const Scene& scene, int frame, const TimeOptions& options, Segment& segment) {
  segment.first = floor_to_multiple(frame, options.segment_length);
  segment.last = segment.first + options.segment_length - 1;
  const int last = last_frame(scene, options);
  // A last piece of less than half a segment joins the segment before.
  const int tail = floor_to_multiple(last, options.segment_length);
  if (tail > 0 && 2 * (last - tail + 1) < options.segment_length && frame <= last &&
      frame >= tail - options.segment_length) {
    segment.first = tail - options.segment_length;
    segment.last = last;
    return;
  }
  if (last == 0 || segment.first > last || segment.last <= last) return;
  (frame <= last ? segment.last : segment.first) = frame <= last ? last : last + 1;
}

/// The name of what a track changes.
const char* word_of(const AnimationTrack& track) {
  switch (track.path) {
    case Path::translation: return "translation";
    case Path::rotation: return "rotation";
    case Path::scale: return "scale";
    case Path::weights: return "weights";
    case Path::visible: return "visibility";
    case Path::material: return material_properties()[track.property].name;
    case Path::light_color: return "colour";
    case Path::light_intensity: return "intensity";
    case Path::inner_cone: return "inner cone";
    case Path::outer_cone: return "outer cone";
    case Path::yfov: return "yfov";
    case Path::ymag: return "ymag";
  }
  return "";
}

bool differs_in(const AnimationTrack& track, const Segment& segment, double fps) {
  std::vector<double> first(track.components), now(track.components);
  evaluate(track, segment.first / fps, first);
  for (int f = segment.first + 1; f <= segment.last; ++f) {
    evaluate(track, f / fps, now);
    if (now != first) return true;
  }
  return false;
}

std::string name_of(const Node& node) {
  return node.name.empty() ? "node " + std::to_string(node.source_index) : node.name;
}

/// Why a node moves, for people: the animated properties of the node that differ between two frames; else its parent or
/// a joint.
std::string reason(const Scene& scene, const Animator& animator, const Segment& segment, std::size_t n, double fps) {
  std::string properties;
  const Node& node = scene.nodes[n];
  for (const AnimationTrack* track : animator.tracks(n))
    if ((node.skin < 0 || track->path >= Path::weights) && differs_in(*track, segment, fps))
      properties += (properties.empty() ? "" : ", ") + std::string(word_of(*track));
  if (!properties.empty()) return properties + " of " + name_of(node);
  if (node.skin >= 0)
    for (const int joint : scene.skins[std::size_t(node.skin)].joints)
      if (segment.node_moves[std::size_t(joint)]) return "joint " + name_of(scene.nodes[std::size_t(joint)]);
  return node.parent < 0 ? "its shape" : "parent " + name_of(scene.nodes[std::size_t(node.parent)]);
}

/// Marks the nodes that are hidden at all frames. Nodes that are hidden at some frames only are marked as movers.
void set_hidden(const Scene& scene, const Animator& animator, double fps, Segment& segment) {
  const std::vector<std::uint8_t> first = animator.seen(segment.first / fps);
  segment.node_hidden.resize(first.size());
  for (std::size_t n = 0; n < first.size(); ++n) segment.node_hidden[n] = !first[n];
  if (!animator.anything_animated()) return;
  for (int f = segment.first + 1; f <= segment.last; ++f) {
    const std::vector<std::uint8_t> seen = animator.seen(f / fps);
    for (std::size_t n = 0; n < first.size(); ++n) {
      if (seen[n]) segment.node_hidden[n] = 0;
      if (seen[n] != first[n]) segment.node_moves[n] = 1, segment.hides_at_times = true;
    }
  }
  for (std::size_t n = 0; n < first.size(); ++n)
    if (segment.node_hidden[n] && (scene.nodes[n].mesh >= 0 || scene.nodes[n].light >= 0) && scene.nodes[n].camera < 0)
      segment.node_moves[n] = 0;
}

/// Marks the nodes whose state differs between two frames. A skinned mesh has the state of its joints; the transform of
/// its own node does not count.
void set_moves(const Scene& scene, const Animator& animator, const std::vector<Affine>& first_world, double fps,
               Segment& segment) {
  const std::size_t count = scene.nodes.size();
  std::vector<std::size_t> deforming;
  for (std::size_t n = 0; n < count; ++n)
    if (deforms(scene, scene.nodes[n])) deforming.push_back(n);
  std::vector<Pose> first;
  for (const std::size_t n : deforming) first.push_back(animator.pose(n, segment.first / fps, first_world));
  std::vector<std::uint8_t> shape_moves(count, 0);
  for (int f = segment.first + 1; f <= segment.last; ++f) {
    const std::vector<Affine> world = animator.world_from_node(f / fps);
    for (std::size_t n = 0; n < count; ++n)
      if (!(world[n] == first_world[n])) segment.node_moves[n] = 1;
    for (std::size_t d = 0; d < deforming.size(); ++d)
      if (!shape_moves[deforming[d]] && !(animator.pose(deforming[d], f / fps, world) == first[d]))
        shape_moves[deforming[d]] = 1;
  }
  for (const std::size_t n : deforming) {
    const Node& node = scene.nodes[n];
    const auto& primitives = scene.meshes[std::size_t(node.mesh)].primitives;
    const bool follows_node = node.skin < 0 || node.camera >= 0 || node.light >= 0 ||
                              std::ranges::any_of(primitives, [](const Primitive& p) { return p.influences.empty(); });
    segment.node_moves[n] = shape_moves[n] || (follows_node && segment.node_moves[n]);
  }
}

/// Lists the materials, lights and cameras that change. A node whose material or light changes counts as moving, since
/// its light differs.
void add_changes(const Scene& scene, const Animator& animator, double fps, Segment& segment) {
  for (const AnimationTrack* track : animator.property_tracks()) {
    if (!differs_in(*track, segment, fps)) continue;
    const std::string kind = kind_of(track->path);
    const std::size_t i = std::size_t(track->target);
    std::string name = kind == "material" ? scene.materials[i].name
                       : kind == "light"  ? scene.lights[i].name
                                          : scene.cameras[i].name;
    if (name.empty()) name = kind + " " + std::to_string(i);
    segment.changes.push_back({name, std::string(word_of(*track)) + " of " + name, kind});
    if (kind == "camera") continue;
    for (std::size_t n = 0; n < scene.nodes.size(); ++n) {
      const Node& node = scene.nodes[n];
      const bool has = kind == "light"
                           ? node.light == int(track->target)
                           : node.mesh >= 0 && std::ranges::any_of(scene.meshes[std::size_t(node.mesh)].primitives,
                                                                   [&](const Primitive& p) {
                                                                     return int(p.material) == int(track->target);
                                                                   });
      if (!has || segment.node_moves[n] || segment.node_hidden[n]) continue;
      segment.node_moves[n] = 1;
      segment.why_moves[n] = std::string(word_of(*track)) + " of its " + kind;
    }
  }
}

Box3d local_box(const Mesh& mesh) {
  Box3d box;
  for (const Primitive& primitive : mesh.primitives)
    for (const Vec3& p : primitive.positions) box.add(Vec3d(p));
  return box;
}

/// Adds the vertices of static surfaces to the segment's bounds; for instances and posed meshes, their boxes.
void add_static_bounds(const Scene& scene, const Animator& animator, const std::vector<Affine>& world, double time_s,
                       Segment& segment) {
  const Sharing sharing(scene);
  for (std::size_t n = 0; n < scene.nodes.size(); ++n) {
    const Node& node = scene.nodes[n];
    if (node.mesh < 0 || segment.node_moves[n] || segment.node_hidden[n]) continue;
    if (deforms(scene, node)) {
      const PoseBounds bounds(scene, node);
      for (const Affine& place : places(node, world[n]))
        bounds.add_to(segment.world_bounds, animator.pose(n, time_s, world), place);
      continue;
    }
    for (const Affine& place : places(node, world[n]))
      for (const Primitive& primitive : scene.meshes[std::size_t(node.mesh)].primitives)
        if (sharing.instanced(primitive, place)) add_corners(segment.world_bounds, sharing.box(primitive), place);
        else
          for (const Vec3& p : primitive.positions) segment.world_bounds.add(place.point(Vec3d(p)));
  }
}

/// Adds the boxes of moving meshes at every frame to the segment's bounds.
void add_moving_bounds(const Scene& scene, const Animator& animator, double fps, Segment& segment) {
  std::vector<std::pair<std::size_t, Box3d>> rigid;
  std::vector<std::pair<std::size_t, PoseBounds>> deforming;
  for (std::size_t n = 0; n < scene.nodes.size(); ++n) {
    const Node& node = scene.nodes[n];
    if (node.mesh < 0 || !segment.node_moves[n] || segment.node_hidden[n]) continue;
    if (deforms(scene, node)) deforming.emplace_back(n, PoseBounds(scene, node));
    else rigid.emplace_back(n, local_box(scene.meshes[std::size_t(node.mesh)]));
  }
  if (rigid.empty() && deforming.empty()) return;
  for (int f = segment.first; f <= segment.last; ++f) {
    const std::vector<Affine> world = animator.world_from_node(f / fps);
    const std::vector<std::uint8_t> seen = animator.seen(f / fps);
    for (const auto& [n, box] : rigid) {
      if (!seen[n]) continue;
      for (const Affine& place : places(scene.nodes[n], world[n])) add_corners(segment.world_bounds, box, place);
    }
    for (const auto& [n, bounds] : deforming) {
      if (!seen[n]) continue;
      for (const Affine& place : places(scene.nodes[n], world[n]))
        bounds.add_to(segment.world_bounds, animator.pose(n, f / fps, world), place);
    }
  }
}

/// The origin of scene space. Its coordinates are multiples of a power of two, four to eight diagonals, so that small
/// edits do not move it.
Vec3d scene_origin(const Box3d& bounds) {
  const Vec3d centre = bounds.centre();
  const double diagonal = bounds.diagonal();
  if (!(length(centre) > kFarRatio * diagonal)) return {};
  const double step = std::exp2(std::ceil(std::log2(std::max(diagonal, 1e-6))) + 2);
  return {std::round(centre.x / step) * step, std::round(centre.y / step) * step, std::round(centre.z / step) * step};
}

}  // namespace

int frame_in_animation(const Scene& scene, int frame, const TimeOptions& options) {
  const int last = last_frame(scene, options);
  return last > 0 && frame > last ? last : std::max(frame, 0);
}

Segment segment_of(const Scene& scene, int frame, const TimeOptions& options) {
  if (!(options.fps > 0) || options.segment_length < 1)
    throw std::invalid_argument("segment_of: fps and segment length must be above 0");
  Segment borders;
  set_borders(scene, frame, options, borders);
  return segment_between(scene, borders.first, borders.last, options);
}

Segment segment_between(const Scene& scene, int first_of_all, int last_of_all, const TimeOptions& options) {
  Segment segment;
  segment.first = first_of_all;
  segment.last = last_of_all;
  const Animator animator(scene);
  const std::size_t count = scene.nodes.size();
  segment.node_moves.assign(count, 0);
  segment.why_moves.assign(count, "");
  const std::vector<Affine> first = animator.world_from_node(segment.first / options.fps);
  if (animator.anything_animated()) set_moves(scene, animator, first, options.fps, segment);
  set_hidden(scene, animator, options.fps, segment);
  for (std::size_t n = 0; n < count; ++n)
    if (segment.node_moves[n]) segment.why_moves[n] = reason(scene, animator, segment, n, options.fps);
  add_changes(scene, animator, options.fps, segment);
  add_static_bounds(scene, animator, first, segment.first / options.fps, segment);
  add_moving_bounds(scene, animator, options.fps, segment);
  if (!is_finite(segment.world_bounds.lower) || !is_finite(segment.world_bounds.upper))
    throw InputError(scene.path + ": nodes: transforms take the geometry beyond what numbers can hold");
  segment.origin = scene_origin(segment.world_bounds);
  return segment;
}

std::vector<Affine> world_from_node(const Scene& scene, int frame, const TimeOptions& options) {
  return Animator(scene).world_from_node(frame / options.fps);
}

}  // namespace tempolux
