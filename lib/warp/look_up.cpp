#include "lib/warp/look_up.h"

#include <cmath>

namespace tempolux {
namespace {

/// Pixels from a pixel's centre within which a position is that pixel: interpolation could change it by less than a thousandth of
/// its difference to its neighbour, and what stands keeps its bits.
constexpr double kSamePixel = 1e-3;

}  // namespace

KeyView::KeyView(const KeyFrame& key, const FrameCamera& camera, const FrameCamera& target,
                 const ObjectMotions& key_from_target)
    : key_(key), camera_(camera), target_(target), motions_(key_from_target), same_camera_(camera == target) {
  // Composed in double, camera to camera: the difference of the cameras is taken before any point is added to it.
  still_ = same_camera_ ? Affine{} : camera.camera_from_world() * target.world_from_camera();
  if (motions_.all_still()) return;
  moved_.resize(motions_.count(), still_);
  for (std::uint32_t object = 0; object < moved_.size(); ++object)
    if (motions_.of(object).kind == ObjectMotion::Kind::moved)
      moved_[object] = camera.camera_from_world() * (motions_.of(object).other_from_here * target.world_from_camera());
}

LookUp KeyView::find(const Wanted& wanted, Taps& taps, float& magnification) const {
  const FacePoint& point = wanted.point;
  const bool moves = point.object < moved_.size();
  if (moves) {
    const ObjectMotion::Kind kind = motions_.of(point.object).kind;
    if (kind == ObjectMotion::Kind::deforming) return LookUp::deforming;
    if (kind == ObjectMotion::Kind::absent) return LookUp::hidden;
  }
  const Affine& to_key = moves ? moved_[point.object] : still_;
  const bool infinite = !(point.depth < INFINITY);
  const Vec3d there = infinite ? to_key.direction(wanted.at) : to_key.point(wanted.at);
  const auto raster = infinite ? camera_.project_direction(there) : camera_.project(there);
  const SeenSurfaces& seen = key_.seen();
  if (!raster || !(raster->x >= 0 && raster->y >= 0 && raster->x < seen.width && raster->y < seen.height))
    return LookUp::outside;

  FacePoint face{infinite ? INFINITY : float(there.z), point.object, point.normal};   // in the key's world
  float facing = 1;
  magnification = 1;
  if (!infinite) {
    Vec3d normal{0, 0, 1};   // in the key's camera space; if none is known, towards the camera
    if (length2(point.normal) > 0) {
      if (moves && motions_.of(point.object).kind == ObjectMotion::Kind::moved)
        face.normal = Vec3(normalize(motions_.of(point.object).other_from_here.normal(Vec3d(point.normal))));
      normal = camera_.camera_from_world().direction(Vec3d(face.normal));
      facing = float(camera_.orthographic() ? std::abs(normal.z) : std::abs(dot(normal, there)) / length(there));
    }
    magnification = float(camera_.area_of_pixel(there, normal) / wanted.area);
  }
  const float tolerance = depth_tolerance(camera_.orthographic() ? 0 : float(camera_.pixel_width()), facing);
  return gather(raster->x - 0.5, raster->y - 0.5, face, tolerance, taps);
}

LookUp KeyView::gather(double cx, double cy, const FacePoint& face, float tolerance, Taps& taps) const {
  const SeenSurfaces& seen = key_.seen();
  const int width = seen.width, height = seen.height;
  const auto index = [&](int x, int y) { return std::uint32_t(y) * std::uint32_t(width) + std::uint32_t(x); };
  const auto shows = [&](std::uint32_t p) {
    return same_face({seen.depth[p], seen.object_at(p), seen.normal_at(p)}, face, tolerance);
  };
  const int x0 = int(std::floor(cx)), y0 = int(std::floor(cy));
  const float fx = float(cx - x0), fy = float(cy - y0);
  const int nx = x0 + (fx >= 0.5f), ny = y0 + (fy >= 0.5f);
  const bool inside = nx < width && ny < height;   // nx, ny >= 0 as the position lies in the picture
  const bool nearest_shows = inside && shows(index(nx, ny));

  if (nearest_shows && key_.whole(index(nx, ny))) {
    if (std::abs(cx - nx) < kSamePixel && std::abs(cy - ny) < kSamePixel) {
      taps.count = 1;
      taps.pixel[0] = index(nx, ny);
      taps.weight[0] = 1;
      return LookUp::found;
    }
    // The other three are among the 8 around a whole pixel: they show its face.
    if (x0 >= 0 && y0 >= 0 && x0 + 1 < width && y0 + 1 < height) {
      const std::uint32_t p = index(x0, y0), q = p + std::uint32_t(width);
      if (key_.whole(p) && key_.whole(p + 1) && key_.whole(q) && key_.whole(q + 1)) {
        taps = {4, {p, p + 1, q, q + 1}, {(1 - fx) * (1 - fy), fx * (1 - fy), (1 - fx) * fy, fx * fy}};
        return LookUp::found;
      }
    }
  }
  bool edge = nearest_shows;
  const auto usable = [&](int x, int y) {
    if (x < 0 || y < 0 || x >= width || y >= height || !shows(index(x, y))) return false;
    edge = true;
    return key_.whole(index(x, y));
  };
  taps.count = 0;
  float sum = 0;
  for (int dy = 0; dy < 2; ++dy)
    for (int dx = 0; dx < 2; ++dx) {
      const float weight = (dx ? fx : 1 - fx) * (dy ? fy : 1 - fy);
      if (!(weight > 0) || !usable(x0 + dx, y0 + dy)) continue;
      taps.pixel[std::size_t(taps.count)] = index(x0 + dx, y0 + dy);
      taps.weight[std::size_t(taps.count++)] = weight;
      sum += weight;
    }
  if (sum > 0) {
    for (int t = 0; t < taps.count; ++t) taps.weight[std::size_t(t)] /= sum;
    return LookUp::found;
  }
  float nearest = INFINITY;
  for (int y = y0 - 1; y <= y0 + 2; ++y)
    for (int x = x0 - 1; x <= x0 + 2; ++x) {
      const float dx = float(x - cx), dy = float(y - cy), distance = dx * dx + dy * dy;
      if (!(distance < nearest) || !usable(x, y)) continue;
      nearest = distance;
      taps.count = 1;
      taps.pixel[0] = index(x, y);
      taps.weight[0] = 1;
    }
  return nearest < INFINITY ? LookUp::found : edge ? LookUp::edge : LookUp::hidden;
}

}  // namespace tempolux
