// lib/core/affine.h -- affine transforms in double precision, named target_from_source.
#pragma once

#include <array>

#include "lib/core/vec.h"

namespace tempolux {

/// x' = m x + t, where `row` has the rows of m. Transforms compose by matching inner names: world_from_node *
/// node_from_child. The default is the identity.
struct Affine {
  std::array<Vec3d, 3> row{Vec3d{1, 0, 0}, Vec3d{0, 1, 0}, Vec3d{0, 0, 1}};
  Vec3d translation{};

  bool operator==(const Affine&) const = default;
  /// A vector under the transform, without translation.
  Vec3d direction(Vec3d d) const { return {dot(row[0], d), dot(row[1], d), dot(row[2], d)}; }
  Vec3d point(Vec3d p) const { return direction(p) + translation; }
  /// A normal under the transform, by the inverse transpose of m; not normalised.
  Vec3d normal(Vec3d n) const {
    const Vec3d c0 = cross(row[1], row[2]), c1 = cross(row[2], row[0]), c2 = cross(row[0], row[1]);
    const Vec3d v = Vec3d{dot(c0, n), dot(c1, n), dot(c2, n)};
    return determinant() < 0 ? -v : v;
  }
  /// Volume of the transformed unit cube, negative if the transform mirrors.
  double determinant() const { return dot(row[0], cross(row[1], row[2])); }

  friend Affine operator*(const Affine& a, const Affine& b) {
    Affine r;
    for (int i = 0; i < 3; ++i)
      r.row[std::size_t(i)] =
          a.row[std::size_t(i)].x * b.row[0] + a.row[std::size_t(i)].y * b.row[1] + a.row[std::size_t(i)].z * b.row[2];
    r.translation = a.point(b.translation);
    return r;
  }
};

/// The inverse transform. determinant() must not be 0, else the result holds infinities or NaN.
inline Affine inverse(const Affine& a) {
  const Vec3d c0 = cross(a.row[1], a.row[2]), c1 = cross(a.row[2], a.row[0]), c2 = cross(a.row[0], a.row[1]);
  const double d = 1 / a.determinant();
  Affine r;
  r.row = {Vec3d{c0.x, c1.x, c2.x} * d, Vec3d{c0.y, c1.y, c2.y} * d, Vec3d{c0.z, c1.z, c2.z} * d};
  r.translation = -r.direction(a.translation);
  return r;
}

/// The transform that scales by s, then rotates by the unit quaternion q = (x, y, z, w), then moves by t: glTF's T R S.
inline Affine affine_from_trs(Vec3d t, std::array<double, 4> q, Vec3d s) {
  const auto [x, y, z, w] = q;
  Affine r;
  r.row = {Vec3d{(1 - 2 * (y * y + z * z)) * s.x, (2 * (x * y - z * w)) * s.y, (2 * (x * z + y * w)) * s.z},
           Vec3d{(2 * (x * y + z * w)) * s.x, (1 - 2 * (x * x + z * z)) * s.y, (2 * (y * z - x * w)) * s.z},
           Vec3d{(2 * (x * z - y * w)) * s.x, (2 * (y * z + x * w)) * s.y, (1 - 2 * (x * x + y * y)) * s.z}};
  r.translation = t;
  return r;
}

}  // namespace tempolux
