#include "lib/scene/static_scene.h"

#include <algorithm>
#include <cmath>
#include <span>

#include "lib/scene/place_surfaces.h"
#include "lib/scene/scene_hash.h"

namespace tempolux {
namespace {

/// Boxes are widened by this share of the largest coordinate, as in the search trees (trees.h).
constexpr float kMargin = 0x1p-18f;
/// Least mean number of triangles per piece. With it the pieces of a surface take less memory than its vertices and
/// indices.
constexpr double kTrianglesOfPiece = 4;
/// Largest number of cells along an axis (docs/methods/dynamic.md). More cells let fewer paths be traced again; the
/// light is the same.
constexpr std::size_t kMostAlong = 4;

/// Widens a box by kMargin of the largest coordinate.
Box3 widened(const Box3& box) {
  if (box.empty()) return box;
  const float margin = kMargin * max_component(max(abs(box.lower), abs(box.upper)));
  return {box.lower - Vec3{margin, margin, margin}, box.upper + Vec3{margin, margin, margin}};
}

/// Boxes of the surface's pieces; `box` is the surface's own. Empty if the surface has too few triangles for two
/// pieces.
std::vector<Box3> pieces_of(const Surface& surface, const Box3& box) {
  const auto& triangles = surface.primitive->triangles;
  const auto along = std::min(std::size_t(std::cbrt(double(triangles.size()) / kTrianglesOfPiece)), kMostAlong);
  if (along < 2) return {};
  std::vector<Box3> pieces(along * along * along);
  const auto cell_of = [&](Vec3 centre) {
    std::size_t cell = 0;
    for (int axis = 0; axis < 3; ++axis) {
      const float edge = box.upper[axis] - box.lower[axis];
      const float part = edge > 0 ? (centre[axis] - box.lower[axis]) / edge * float(along) : 0;
      cell = cell * along + std::min(std::size_t(std::max(part, 0.0f)), along - 1);
    }
    return cell;
  };
  for (const auto& corner : triangles) {
    Box3 triangle;
    for (const std::uint32_t vertex : corner) triangle.add(surface.position(vertex));
    pieces[cell_of(triangle.centre())].add(triangle);
  }
  for (Box3& piece : pieces) piece = widened(piece);
  return pieces;
}

}  // namespace

SceneFrame static_scene_of(SceneFrame frame) {
  for (std::size_t s = frame.static_count; s < frame.surfaces.size(); ++s) shrink(frame.surfaces[s], Vec3{});
  std::vector<PlacedLight> static_lights;
  for (PlacedLight& placed : frame.lights) {
    if (frame.segment.moves(placed.node)) placed.light.intensity = Rgb(0.0f);
    else static_lights.push_back(placed);
  }
  if (!frame.scene) return frame;  // the scene is not from a file, so there is no other frame to compare with
  const Scene& scene = *frame.scene;
  const std::span<const Surface> fixed(frame.surfaces.data(), frame.static_count);
  const std::span<const std::uint8_t> left_out(frame.segment.node_moves);
  frame.hashes.static_geometry = geometry_hash(scene, frame.origin, fixed, left_out);
  frame.hashes.moving_geometry = geometry_hash(scene, frame.origin, {}, left_out);
  frame.hashes.materials = materials_hash(scene, frame.materials, left_out);
  frame.hashes.lights = lights_hash(scene, frame.origin, static_lights, frame.materials, fixed);
  return frame;
}

void MovingBoxes::add(const MovingBoxes& other) {
  const std::size_t known = surfaces.size();
  surfaces.resize(std::max(known, other.surfaces.size()));
  pieces.resize(surfaces.size());
  for (std::size_t i = 0; i < other.surfaces.size(); ++i) {
    surfaces[i].add(other.surfaces[i]);
    const std::span<const Box3> more = other.pieces_of(i);
    if (i >= known) pieces[i].assign(more.begin(), more.end());
    // Pieces of two frames are joined by their numbers. If there are not equally many, the surface has its own box
    // only.
    else if (pieces[i].size() != more.size()) pieces[i].clear();
    else
      for (std::size_t k = 0; k < more.size(); ++k) pieces[i][k].add(more[k]);
  }
  all.add(other.all);
}

MovingBoxes moving_boxes(const SceneFrame& frame) {
  MovingBoxes boxes;
  for (std::size_t s = frame.static_count; s < frame.surfaces.size(); ++s) {
    const Surface& surface = frame.surfaces[s];
    Box3 box;
    for (std::uint32_t v = 0; v < surface.primitive->positions.size(); ++v) box.add(surface.position(v));
    boxes.pieces.push_back(pieces_of(surface, box));
    boxes.surfaces.push_back(widened(box));
    boxes.all.add(boxes.surfaces.back());
  }
  return boxes;
}

}  // namespace tempolux
