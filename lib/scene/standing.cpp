#include "lib/scene/standing.h"

#include <span>

#include "lib/scene/scene_hash.h"

namespace tempolux {
namespace {

/// Boxes of rays' targets are this much larger, of the largest coordinate: that of the search trees (trees.h).
constexpr float kMargin = 0x1p-18f;

bool moves(const SceneFrame& frame, std::uint32_t node) {
  return node < frame.segment.node_moves.size() && frame.segment.node_moves[node] != 0;
}

/// A surface with all vertices in one place has no area: it can neither be hit nor emit.
void shrink(Surface& surface) {
  surface.positions = std::vector<Vec3>(surface.primitive->positions.size());
  surface.normals = {};
  surface.tangents = {};
}

}  // namespace

SceneFrame standing_scene(SceneFrame frame) {
  for (std::size_t s = frame.static_count; s < frame.surfaces.size(); ++s) shrink(frame.surfaces[s]);
  std::vector<PlacedLight> standing;
  for (PlacedLight& placed : frame.lights) {
    if (moves(frame, placed.node)) placed.light.intensity = Rgb(0.0f);
    else standing.push_back(placed);
  }
  if (!frame.scene) return frame;   // of no file: there is nothing to compare with
  const Scene& scene = *frame.scene;
  const std::span<const Surface> fixed(frame.surfaces.data(), frame.static_count);
  const std::span<const std::uint8_t> left_out(frame.segment.node_moves);
  frame.hashes.static_geometry = geometry_hash(scene, frame.origin, fixed, left_out);
  frame.hashes.moving_geometry = geometry_hash(scene, frame.origin, {}, left_out);
  frame.hashes.materials = materials_hash(scene, frame.materials, left_out);
  frame.hashes.lights = lights_hash(scene, frame.origin, standing, frame.materials, fixed);
  return frame;
}

bool light_moves(const SceneFrame& frame) {
  if (frame.static_count < frame.surfaces.size()) return true;
  for (const PlacedLight& placed : frame.lights)
    if (moves(frame, placed.node)) return true;
  return false;
}

void MovingBoxes::add(const MovingBoxes& other) {
  surfaces.resize(std::max(surfaces.size(), other.surfaces.size()));
  for (std::size_t i = 0; i < other.surfaces.size(); ++i) surfaces[i].add(other.surfaces[i]);
  all.add(other.all);
}

MovingBoxes moving_boxes(const SceneFrame& frame) {
  MovingBoxes boxes;
  for (std::size_t s = frame.static_count; s < frame.surfaces.size(); ++s) {
    const Surface& surface = frame.surfaces[s];
    Box3 box;
    for (std::uint32_t v = 0; v < surface.primitive->positions.size(); ++v) box.add(surface.position(v));
    if (!box.empty()) {
      const float margin = kMargin * max_component(max(abs(box.lower), abs(box.upper)));
      box.lower = box.lower - Vec3{margin, margin, margin};
      box.upper = box.upper + Vec3{margin, margin, margin};
      boxes.all.add(box);
    }
    boxes.surfaces.push_back(box);
  }
  return boxes;
}

}  // namespace tempolux
