// lib/scene/static_scene.h -- the static scene of a segment, and the boxes of its movers.
#pragma once

#include <span>
#include <vector>

#include "lib/core/vec.h"
#include "lib/scene/at_frame.h"

namespace tempolux {

/// The static scene of a segment: static surfaces, and lights that neither move nor change. `frame` is any frame of the
/// segment. Moving surfaces stay in the list, shrunk to a point: no ray hits them and they emit nothing, but indices of
/// surfaces and slots of the emission table are the same as in every frame. Lights of moving nodes have intensity 0.
/// Bounds, origin and segment are the frame's. The hashes are those that the file would have without the meshes and
/// lights of moving nodes and with the same origin.
SceneFrame static_scene_of(SceneFrame frame);

/// Boxes of everything that moves; scene space, m, slightly widened.
struct MovingBoxes {
  std::vector<Box3> surfaces;  ///< one for each moving surface
  /// For each surface the boxes of its pieces, which together hold the whole surface; some may be empty. A surface of
  /// few triangles has no pieces.
  std::vector<std::vector<Box3>> pieces;
  Box3 all;  ///< empty if nothing moves

  /// The boxes of the pieces of a moving surface, by its number among the moving surfaces; empty if it has none.
  std::span<const Box3> pieces_of(std::size_t surface) const {
    return surface < pieces.size() ? std::span<const Box3>(pieces[surface]) : std::span<const Box3>();
  }
  /// Widens each box by the same box at another frame of the segment, piece by piece.
  void add(const MovingBoxes& other);
};
/// A piece is the set of triangles whose centres lie in one cell of a grid of up to 4 x 4 x 4 cells over the surface's
/// box. Pieces bound a surface tightly: rays meet the box of a ball twice as often as the ball itself, but few rays
/// meet a piece's box without meeting the ball (docs/methods/dynamic.md).
MovingBoxes moving_boxes(const SceneFrame& frame);

}  // namespace tempolux
