// lib/scene/segment.cpp -- intervals of frames, what moves in them, and where scene space lies.
#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "formats/error.h"
#include "lib/scene/animate.h"
#include "lib/scene/at_frame.h"

namespace tempolux {
namespace {

using Path = AnimationTrack::Path;

/// Scene space leaves the world's origin when its numbers would lose 6 of float32's 24 bits.
constexpr double kFarRatio = 64;

int floor_to_multiple(int value, int step) {
  const int remainder = value % step;
  return value - (remainder < 0 ? remainder + step : remainder);
}

/// The frame from which on everything rests: that of the last key, or the next if it lies between frames.
int last_frame(const Scene& scene, const TimeOptions& options) {
  const double frame = std::ceil(scene.duration_s * options.fps - 1e-3);
  return frame < 1e9 ? int(frame) : 1'000'000'000;
}

void set_borders(const Scene& scene, int frame, const TimeOptions& options, Segment& segment) {
  segment.first = floor_to_multiple(frame, options.segment_length);
  segment.last = segment.first + options.segment_length - 1;
  const int last = last_frame(scene, options);
  if (last == 0 || segment.first > last || segment.last <= last) return;
  (frame <= last ? segment.last : segment.first) = frame <= last ? last : last + 1;
}

const char* path_word(Path path) {
  switch (path) {
    case Path::translation: return "translation";
    case Path::rotation: return "rotation";
    case Path::scale: return "scale";
    default: return "weights";
  }
}

/// Which of the node's own properties differ between two frames, else that its parent moves.
std::string reason(const Scene& scene, const Animator& animator, const Segment& segment, std::size_t n,
                   double fps) {
  std::string properties;
  for (const AnimationTrack* track : animator.tracks(n)) {
    std::vector<double> first(track->components), now(track->components);
    evaluate(*track, segment.first / fps, first);
    for (int f = segment.first + 1; f <= segment.last; ++f) {
      evaluate(*track, f / fps, now);
      if (now == first) continue;
      properties += (properties.empty() ? "" : ", ") + std::string(path_word(track->path));
      break;
    }
  }
  const Node& node = scene.nodes[n];
  const auto name = [&](const Node& of) {
    return of.name.empty() ? "node " + std::to_string(of.source_index) : of.name;
  };
  if (!properties.empty()) return properties + " of " + name(node);
  return "parent " + name(scene.nodes[std::size_t(node.parent)]);
}

Box3d local_box(const Mesh& mesh) {
  Box3d box;
  for (const Primitive& primitive : mesh.primitives)
    for (const Vec3& p : primitive.positions) box.add(Vec3d(p));
  return box;
}

void add_corners(Box3d& bounds, const Box3d& local, const Affine& world) {
  for (int corner = 0; corner < 8; ++corner)
    bounds.add(
        world.point({corner & 1 ? local.upper.x : local.lower.x, corner & 2 ? local.upper.y : local.lower.y,
                     corner & 4 ? local.upper.z : local.lower.z}));
}

void add_static_bounds(const Scene& scene, const std::vector<Affine>& world, Segment& segment) {
  for (std::size_t n = 0; n < scene.nodes.size(); ++n) {
    if (scene.nodes[n].mesh < 0 || segment.node_moves[n]) continue;
    for (const Primitive& primitive : scene.meshes[std::size_t(scene.nodes[n].mesh)].primitives)
      for (const Vec3& p : primitive.positions) segment.world_bounds.add(world[n].point(Vec3d(p)));
  }
}

/// A moving mesh is bounded by its local box at every frame.
void add_moving_bounds(const Scene& scene, const Animator& animator, double fps, Segment& segment) {
  std::vector<std::pair<std::size_t, Box3d>> moving;
  for (std::size_t n = 0; n < scene.nodes.size(); ++n)
    if (scene.nodes[n].mesh >= 0 && segment.node_moves[n])
      moving.emplace_back(n, local_box(scene.meshes[std::size_t(scene.nodes[n].mesh)]));
  if (moving.empty()) return;
  for (int f = segment.first; f <= segment.last; ++f) {
    const std::vector<Affine> world = animator.world_from_node(f / fps);
    for (const auto& [n, box] : moving) add_corners(segment.world_bounds, box, world[n]);
  }
}

/// Rounded to multiples of a power of two near four diagonals, so that small edits leave it where it is.
Vec3d scene_origin(const Box3d& bounds) {
  const Vec3d centre = bounds.centre();
  const double diagonal = bounds.diagonal();
  if (!(length(centre) > kFarRatio * diagonal)) return {};
  const double step = std::exp2(std::ceil(std::log2(std::max(diagonal, 1e-6))) + 2);
  return {std::round(centre.x / step) * step, std::round(centre.y / step) * step,
          std::round(centre.z / step) * step};
}

}  // namespace

int frame_in_animation(const Scene& scene, int frame, const TimeOptions& options) {
  const int last = last_frame(scene, options);
  return last > 0 && frame > last ? last : std::max(frame, 0);
}

Segment segment_of(const Scene& scene, int frame, const TimeOptions& options) {
  if (!(options.fps > 0) || options.segment_length < 1)
    throw std::invalid_argument("segment_of: fps and segment length must be above 0");
  Segment segment;
  set_borders(scene, frame, options, segment);
  const Animator animator(scene);
  const std::size_t count = scene.nodes.size();
  segment.node_moves.assign(count, 0);
  segment.why_moves.assign(count, "");
  const std::vector<Affine> first = animator.world_from_node(segment.first / options.fps);
  if (std::ranges::find(animator.animated(), true) != animator.animated().end())
    for (int f = segment.first + 1; f <= segment.last; ++f) {
      const std::vector<Affine> world = animator.world_from_node(f / options.fps);
      for (std::size_t n = 0; n < count; ++n)
        if (!(world[n] == first[n])) segment.node_moves[n] = 1;
    }
  for (std::size_t n = 0; n < count; ++n)
    if (segment.node_moves[n]) segment.why_moves[n] = reason(scene, animator, segment, n, options.fps);
  add_static_bounds(scene, first, segment);
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
