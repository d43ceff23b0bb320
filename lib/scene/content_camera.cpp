#include "lib/scene/content_camera.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

#include "lib/scene/animate.h"
#include "lib/scene/at_frame.h"
#include "lib/scene/deform.h"
#include "lib/scene/place_surfaces.h"

namespace tempolux {
namespace {

// docs/methods/content-camera.md gives the reason for each of these constants.
constexpr int kTimes = 8;  ///< times of an animation, evenly spaced, that are evaluated
constexpr std::size_t kMostTriangles = 400'000;
/// A triangle belongs to a ground if it is longer than this many diagonals of all smaller triangles.
constexpr double kGap = 2;
constexpr double kDetail = 0.75;  ///< least share of all triangles that must be smaller
/// Share of the triangles' total length that may be dropped at each end of an axis, if this shortens the axis to less
/// than kShrink of its length.
constexpr double kStrays = 0.005, kShrink = 0.5;
constexpr double kYfov_rad = 0.7, kAspect = 4.0 / 3.0, kMargin = 1.06;
/// glTF's front is +z: the view comes from the front, a little from the right and from above.
const Vec3d kTowardsEye = normalize(Vec3d{0.5, 0.4, 1});

/// A triangle of the scene.
struct Piece {
  std::array<Vec3, 3> corners;  ///< scene space, m
  float length = 0;             ///< diagonal of the triangle's box, m
  float count = 1;              ///< number of triangles of the surface that this one represents
  Vec3 centre() const { return (corners[0] + corners[1] + corners[2]) * (1 / 3.0f); }
};

void add_surfaces(const std::vector<Surface>& surfaces, std::vector<Piece>& pieces) {
  const std::size_t most = std::max<std::size_t>(16, kMostTriangles / (surfaces.size() + 1));
  for (const Surface& surface : surfaces) {
    const auto& triangles = surface.primitive->triangles;
    const std::size_t step = (triangles.size() + most - 1) / most;
    for (std::size_t t = 0; t < triangles.size(); t += step) {
      Piece piece;
      Box3 box;
      for (std::size_t c = 0; c < 3; ++c) box.add(piece.corners[c] = surface.position(triangles[t][c]));
      piece.length = float(box.diagonal());
      piece.count = float(step);
      if (piece.length > 0) pieces.push_back(piece);
    }
  }
}

/// All triangles at time 0, and those of moving nodes at the other times.
std::vector<Piece> pieces_of(const Scene& scene, Segment& segment) {
  const Animator animator(scene);
  const Sharing sharing(scene);
  const std::vector<Affine> first = animator.world_from_node(0);
  std::vector<Piece> pieces;
  const std::vector<std::uint8_t> seen_first = animator.seen(0);
  segment.node_moves.assign(scene.nodes.size(), 0);
  segment.node_hidden.clear();  // a node that is hidden now is shrunk to a point, which is no piece
  add_surfaces(place_surfaces(scene, animator, sharing, segment, {0, first}, false), pieces);
  for (int i = 1; i < kTimes && animator.anything_animated(); ++i) {
    const double time = scene.duration_s * i / (kTimes - 1);
    const std::vector<Affine> world = animator.world_from_node(time);
    const std::vector<std::uint8_t> seen = animator.seen(time);
    for (std::size_t n = 0; n < scene.nodes.size(); ++n)
      segment.node_moves[n] = deforms(scene, scene.nodes[n]) || !(world[n] == first[n]) || seen[n] != seen_first[n];
    add_surfaces(place_surfaces(scene, animator, sharing, segment, {time, world}, true), pieces);
  }
  return pieces;
}

/// Drops the triangles of a ground, a backdrop or a sky: those longer than kGap times the diagonal of all smaller
/// triangles, if at least kDetail of all triangles are smaller.
void leave_out_grounds(std::vector<Piece>& pieces) {
  std::ranges::stable_sort(pieces, {}, &Piece::length);
  double count = 0, whole = 0;
  for (const Piece& piece : pieces) whole += piece.count;
  Box3d box;
  std::size_t kept = pieces.size();
  for (std::size_t i = 0; i < pieces.size(); ++i) {
    if (count >= kDetail * whole && double(pieces[i].length) > kGap * box.diagonal()) kept = i;
    for (const Vec3 p : pieces[i].corners) box.add(Vec3d(p));
    count += pieces[i].count;
  }
  pieces.resize(kept);
}

Box3d box_of(const std::vector<Piece>& pieces) {
  Box3d box;
  for (const Piece& piece : pieces)
    for (const Vec3 p : piece.corners) box.add(Vec3d(p));
  return box;
}

/// The range of the triangles' centres along an axis without the outermost ones, which have kStrays of the total length
/// at each end.
std::array<double, 2> inner_range(const std::vector<Piece>& pieces, int axis) {
  std::vector<std::pair<double, double>> centres;
  double whole = 0;
  for (const Piece& piece : pieces) {
    const double weight = double(piece.length) * double(piece.count);
    centres.emplace_back(piece.centre()[axis], weight);
    whole += weight;
  }
  std::ranges::sort(centres);
  const auto at_share = [&](double share) {
    double sum = 0;
    for (const auto& [centre, weight] : centres)
      if ((sum += weight) >= share * whole) return centre;
    return centres.back().first;
  };
  return {at_share(kStrays), at_share(1 - kStrays)};
}

/// True if dropping strays cannot shorten the axis from `low` to `high` to less than kShrink, because either end of
/// length (1 - kShrink) / 2 holds more than kStrays of the total length. Most scenes pass this test, which needs no
/// sorting.
bool has_full_ends(const std::vector<Piece>& pieces, int axis, double low, double high) {
  const double end = (high - low) * (1 - kShrink) / 2;
  double whole = 0, first = 0, last = 0;
  for (const Piece& piece : pieces) {
    const double at = double(piece.centre()[axis]), weight = double(piece.length) * double(piece.count);
    whole += weight;
    first += at <= low + end ? weight : 0;
    last += at >= high - end ? weight : 0;
  }
  return std::min(first, last) > kStrays * whole;
}

/// Drops stray triangles where this shortens an axis to less than kShrink.
void leave_out_strays(std::vector<Piece>& pieces) {
  if (pieces.empty()) return;
  for (int axis = 0; axis < 3; ++axis) {
    const Box3d all = box_of(pieces);
    if (has_full_ends(pieces, axis, all.lower[axis], all.upper[axis])) continue;
    const auto range = inner_range(pieces, axis);
    const auto inside = [&](const Piece& piece) {
      const double at = double(piece.centre()[axis]);
      return at >= range[0] && at <= range[1];
    };
    std::vector<Piece> kept;
    std::ranges::copy_if(pieces, std::back_inserter(kept), inside);
    const Box3d inner = box_of(kept);
    if (inner.upper[axis] - inner.lower[axis] < kShrink * (all.upper[axis] - all.lower[axis])) pieces.swap(kept);
  }
}

/// Axes right, up and backward of a camera that looks along -`backward`.
std::array<Vec3d, 3> axes_of(Vec3d backward) {
  const Vec3d right = normalize(cross(Vec3d{0, 1, 0}, backward));
  return {right, cross(backward, right), backward};
}

/// The closest point from which a picture of aspect kAspect contains all corners. In the camera's axes a corner
/// (x, y, z) is visible from the eye (ex, ey, ez) if |y - ey| <= t (ez - z), where t is the tangent of half the angle
/// of view. So each corner gives lower limits of ey + t ez and of t ez - ey; x likewise.
Vec3d eye_for(const std::vector<Piece>& pieces, const std::array<Vec3d, 3>& axes) {
  const double ty = std::tan(kYfov_rad / 2) / kMargin, tx = ty * kAspect;
  constexpr double kNone = -1e300;
  double right = kNone, left = kNone, up = kNone, down = kNone;
  for (const Piece& piece : pieces)
    for (const Vec3 corner : piece.corners) {
      const Vec3d p(corner);
      const double x = dot(p, axes[0]), y = dot(p, axes[1]), z = dot(p, axes[2]);
      right = std::max(right, x + tx * z), left = std::max(left, -x + tx * z);
      up = std::max(up, y + ty * z), down = std::max(down, -y + ty * z);
    }
  const double distance = std::max((right + left) / (2 * tx), (up + down) / (2 * ty));
  return axes[0] * ((right - left) / 2) + axes[1] * ((up - down) / 2) + axes[2] * distance;
}

/// The rotation that takes the axes x, y, z to `a`, as a quaternion x y z w. The largest component is computed first,
/// so that no division by a small number occurs.
std::array<double, 4> quaternion_of(const std::array<Vec3d, 3>& a) {
  const double m00 = a[0].x, m11 = a[1].y, m22 = a[2].z;
  const std::array<double, 4> squares{1 + m00 - m11 - m22, 1 - m00 + m11 - m22, 1 - m00 - m11 + m22,
                                      1 + m00 + m11 + m22};
  const auto largest = std::size_t(std::ranges::max_element(squares) - squares.begin());
  const double s = 0.5 / std::sqrt(squares[largest]);
  const double xy = (a[1].x + a[0].y) * s, xz = (a[2].x + a[0].z) * s, yz = (a[2].y + a[1].z) * s;
  const double wx = (a[1].z - a[2].y) * s, wy = (a[2].x - a[0].z) * s, wz = (a[0].y - a[1].x) * s;
  const double self = squares[largest] * s;
  if (largest == 0) return {self, xy, xz, wx};
  if (largest == 1) return {xy, self, yz, wy};
  if (largest == 2) return {xz, yz, self, wz};
  return {wx, wy, wz, self};
}

std::string text(Vec3d p) {
  char buffer[96];
  std::snprintf(buffer, sizeof buffer, "(%.4g, %.4g, %.4g)", p.x, p.y, p.z);
  return buffer;
}

}  // namespace

std::string add_content_camera(Scene& scene) {
  Segment segment = segment_of(scene, 0, {});
  std::vector<Piece> pieces = pieces_of(scene, segment);
  leave_out_grounds(pieces);
  leave_out_strays(pieces);
  const std::array<Vec3d, 3> axes = axes_of(kTowardsEye);
  Camera camera;
  camera.name = "auto";
  camera.yfov_rad = kYfov_rad;
  Node node;
  node.name = "auto";
  node.source_index = std::uint32_t(scene.nodes.size());
  node.camera = int(scene.cameras.size());
  node.rotation = quaternion_of(axes);
  node.translation = segment.origin + (pieces.empty() ? axes[2] : eye_for(pieces, axes));
  scene.cameras.push_back(camera);
  scene.nodes.push_back(node);
  return "no camera: --camera auto looks at what the scene holds from " + text(node.translation) + " towards " +
         text(segment.origin + (pieces.empty() ? Vec3d{} : box_of(pieces).centre()));
}

}  // namespace tempolux
