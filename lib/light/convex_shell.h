// lib/light/convex_shell.h -- closed convex emitters, whose inside nobody outside sees.
#pragma once

#include <optional>

#include "lib/scene/at_frame.h"

namespace tempolux {

/// A ball around something.
struct Ball {
  Vec3 centre{};
  float radius = INFINITY;   ///< INFINITY: around everything
  bool operator==(const Ball&) const = default;
  bool holds(Vec3 point) const { return length2(point - centre) <= radius * radius; }
};

/// The ball around a surface that is closed and convex, to a hundred thousandth of its size, and whose normals point outwards: from
/// a point outside the ball the back of each of its triangles is hidden by others. None if it is not, or has more than 1024
/// triangles: that is not looked into.
std::optional<Ball> convex_shell(const Surface& surface);

}  // namespace tempolux
