#include "lib/warp/look_up.h"

#include <cmath>

namespace tempolux {
namespace {

/// A position within this distance [pixels] of a pixel's centre counts as the centre, so that unmoved pixels keep their
/// bits. Interpolation would change the colour by less than a thousandth of the difference to the neighbour.
constexpr double kSamePixel = 1e-3;

}  // namespace

KeyView::KeyView(const KeyFrame& key, const FrameCamera& camera, const FrameCamera& target,
                 const ObjectMotions& key_from_target)
    : key_(key), camera_(camera), target_(target), motions_(key_from_target), same_camera_(camera == target) {
  // One transform from camera to camera, in double: world coordinates may be large, the cameras differ by little.
  still_ = same_camera_ ? Affine{} : camera.camera_from_world() * target.world_from_camera();
  if (motions_.all_still()) return;
  moved_ = motions_.transforms(camera.camera_from_world(), target.world_from_camera(), still_);
}

void WantedPoints::place(const FrameCamera& camera) {
  for (std::size_t i = 0; i < count; ++i) {
    const bool far = !(face[i].depth < INFINITY);
    const Vec3d point = camera.unproject(at[i], far ? 1 : double(face[i].depth));
    x[i] = point.x;
    y[i] = point.y;
    z[i] = point.z;
  }
  const Affine& turn = camera.camera_from_world();
  for (std::size_t i = 0; i < count; ++i) {
    const Vec3d world(face[i].normal);
    const bool known = dot(world, world) > 0;
    const Vec3d turned = turn.direction(world),
                normal{known ? turned.x : 0, known ? turned.y : 0, known ? turned.z : 1};
    area[i] = camera.area_of_pixel({x[i], y[i], z[i]}, normal);
  }
}

KeyView::Place KeyView::place(const WantedPoints& wanted, std::size_t i) const {
  const FacePoint& point = wanted.face[i];
  const bool moves = point.object < moved_.size(), infinite = !(point.depth < INFINITY);
  const Affine& to_key = moves ? moved_[point.object] : still_;
  const Vec3d at{wanted.x[i], wanted.y[i], wanted.z[i]}, there = infinite ? to_key.direction(at) : to_key.point(at);
  Place place{infinite ? camera_.project_direction(there) : camera_.project(there),
              {infinite ? INFINITY : float(there.z), point.object, point.normal}};
  if (infinite) return place;
  Vec3d normal{0, 0, 1};  // in the key's camera space; if unknown, towards the camera
  if (length2(point.normal) > 0) {
    if (moves && motions_.of(point.object).kind == ObjectMotion::Kind::moved)
      place.face.normal = Vec3(normalize(motions_.of(point.object).other_from_here.normal(Vec3d(point.normal))));
    normal = camera_.camera_from_world().direction(Vec3d(place.face.normal));
    place.facing = camera_.facing(there, normal);
  }
  place.magnification = camera_.area_of_pixel(there, normal) / wanted.area[i];
  return place;
}

void KeyView::find(const WantedPoints& wanted, FoundPoints& found) const {
  const SeenSurfaces& seen = key_.seen();
  const float pixel = camera_.orthographic() ? 0 : float(camera_.pixel_width());
  for (std::size_t i = 0; i < wanted.count; ++i) {
    const ObjectMotion::Kind kind = motions_.of(wanted.face[i].object).kind;
    if (kind == ObjectMotion::Kind::deforming || kind == ObjectMotion::Kind::absent) {
      found.result[i] = kind == ObjectMotion::Kind::deforming ? LookUp::deforming : LookUp::hidden;
      continue;
    }
    const Place place = this->place(wanted, i);
    found.magnification[i] = float(place.magnification);
    found.result[i] = LookUp::outside;
    if (const auto& at = place.at; at && at->x >= 0 && at->y >= 0 && at->x < seen.width && at->y < seen.height)
      found.result[i] =
          gather(at->x - 0.5, at->y - 0.5, place.face, depth_tolerance(pixel, float(place.facing)), found.taps[i]);
  }
}

LookUp KeyView::gather(double cx, double cy, const FacePoint& face, float tolerance, Taps& taps) const {
  const int width = key_.seen().width, height = key_.seen().height;
  const auto index = [&](int x, int y) { return std::uint32_t(y) * std::uint32_t(width) + std::uint32_t(x); };
  const auto shows = [&](std::uint32_t p) { return same_face(key_.shown(p), face, tolerance); };
  const int x0 = int(std::floor(cx)), y0 = int(std::floor(cy));
  const float fx = float(cx - x0), fy = float(cy - y0);
  const int nx = x0 + (fx >= 0.5f), ny = y0 + (fy >= 0.5f);
  const bool inside = nx < width && ny < height;  // nx and ny are not negative, since the position lies in the picture
  const bool nearest_shows = inside && shows(index(nx, ny));

  if (nearest_shows && key_.whole(index(nx, ny)) && std::abs(cx - nx) < kSamePixel && std::abs(cy - ny) < kSamePixel) {
    taps = {1, {index(nx, ny)}, {1}};
    return LookUp::found;
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
      taps = {1, {index(x, y)}, {1}};
    }
  return nearest < INFINITY ? LookUp::found : edge ? LookUp::edge : LookUp::hidden;
}

}  // namespace tempolux
