// lib/core/box_corners.h -- boxes under affine transforms.
#pragma once

#include "lib/core/affine.h"
#include "lib/core/vec.h"

namespace tempolux {

/// Calls body(corner) for the eight corners of a box after the transform; not at all for an empty box.
template <class Body>
void for_corners(const Affine& to_from, const Box3d& box, const Body& body) {
  if (box.empty()) return;
  for (int corner = 0; corner < 8; ++corner)
    body(to_from.point({corner & 1 ? box.upper.x : box.lower.x, corner & 2 ? box.upper.y : box.lower.y,
                        corner & 4 ? box.upper.z : box.lower.z}));
}

/// Extends `bounds` by the transformed box.
inline void add_corners(Box3d& bounds, const Box3d& box, const Affine& to_from) {
  for_corners(to_from, box, [&](Vec3d corner) { bounds.add(corner); });
}

}  // namespace tempolux
