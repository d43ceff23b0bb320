// lib/scene/standing.h -- the scene without what moves: what a segment's frames have in common.
#pragma once

#include <span>
#include <vector>

#include "lib/core/vec.h"
#include "lib/scene/at_frame.h"

namespace tempolux {

/// The scene of a segment as it stands: static surfaces, and the lights that neither move nor change. `frame` is any
/// frame of the segment. Surfaces that move stay in the list, shrunk to a point, so that indices and the slots of the
/// emission table are those of every frame: no ray meets them and they emit nothing. Lights of moving nodes have
/// intensity 0. Bounds, origin and segment are those of the frame. The hashes are those that the same file has with the
/// moving nodes' meshes and lights taken out, but for the origin where that would lie elsewhere.
SceneFrame standing_scene(SceneFrame frame);

/// Does anything move that light meets or comes from?
bool light_moves(const SceneFrame& frame);

/// Where what moves is: boxes, scene space, m, a little larger than what is in them.
struct MovingBoxes {
  std::vector<Box3> surfaces;  ///< one for each that moves
  /// Closer: of each surface the boxes of its pieces, which together hold all of it; some may be empty. No pieces: its
  /// own box is all that is known.
  std::vector<std::vector<Box3>> pieces;
  Box3 all;  ///< empty if nothing moves

  std::span<const Box3> pieces_of(std::size_t surface) const {
    return surface < pieces.size() ? std::span<const Box3>(pieces[surface]) : std::span<const Box3>();
  }
  /// Widens each box by those of another frame of the segment, piece by piece.
  void add(const MovingBoxes& other);
};
/// Pieces are the triangles whose centres lie in one cell of a grid in the surface's box, up to 4 x 4 x 4 of them: of a
/// ball rays then meet few boxes that do not meet it, while they meet its own box twice as often as itself
/// (docs/methods/dynamic.md).
MovingBoxes moving_boxes(const SceneFrame& frame);

}  // namespace tempolux
