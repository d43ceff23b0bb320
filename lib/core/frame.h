// lib/core/frame.h -- an orthonormal frame around a normal.
#pragma once

#include "lib/core/vec.h"

namespace tempolux {

/// Right-handed orthonormal frame with z = normal. Duff et al., "Building an Orthonormal Basis, Revisited",
/// JCGT 6(1), 2017.
struct Frame {
  Vec3 tangent, bitangent, normal;

  explicit Frame(Vec3 n) : normal(n) {
    const float sign = std::copysign(1.0f, n.z);
    const float a = -1.0f / (sign + n.z), b = n.x * n.y * a;
    tangent = {1.0f + sign * n.x * n.x * a, sign * b, -sign * n.x};
    bitangent = {b, sign + n.y * n.y * a, -n.y};
  }
  /// A vector of the frame (z along the normal) in the space of the normal, and back.
  Vec3 to_world(Vec3 v) const { return tangent * v.x + bitangent * v.y + normal * v.z; }
  Vec3 to_local(Vec3 v) const { return {dot(v, tangent), dot(v, bitangent), dot(v, normal)}; }
};

}  // namespace tempolux
