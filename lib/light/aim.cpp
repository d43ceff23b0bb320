// lib/light/aim.cpp -- starts of parallel light by a mixture of discs.
#include "lib/light/aim.h"

#include <algorithm>

#include "lib/core/check.h"
#include "lib/core/frame.h"
#include "lib/core/sampling.h"

namespace tempolux {
namespace {

Vec2 disc_point(double u, double v) {
  const auto below_one = [](double x) { return std::min(float(x), kOneMinusEpsilon); };
  return sample_disc_concentric({below_one(u), below_one(v)});
}

}  // namespace

Aim::Aim(std::span<const AimSphere> spheres, Vec3 scene_centre, double scene_radius)
    : scene_centre_(scene_centre), scene_radius_(scene_radius) {
  if (!(scene_radius > 0)) return;
  double sum = 0, below = kUniform;
  for (const AimSphere& sphere : spheres) {
    TEMPOLUX_CHECK(sphere.radius > 0 && sphere.weight > 0);
    sum += sphere.weight;
  }
  for (const AimSphere& sphere : spheres) {
    const double share = (1 - kUniform) * sphere.weight / sum, ratio = scene_radius / sphere.radius;
    discs_.push_back({sphere.centre - Vec3d(scene_centre), sphere.radius, below, share, share * ratio * ratio});
    below += share;
  }
}

Aim::Start Aim::start(Vec3 travel, double u, double v) const {
  const Frame axes(travel);
  const Vec3d across(axes.to_world({1, 0, 0})), up(axes.to_world({0, 1, 0}));
  double x, y, density = kUniform;
  std::size_t chosen = discs_.size();
  if (u < kUniform) {
    const Vec2 p = disc_point(u / kUniform, v);
    x = p.x * scene_radius_;
    y = p.y * scene_radius_;
  } else {
    const auto after = std::upper_bound(discs_.begin(), discs_.end(), u, [](double at, const Disc& d) { return at < d.below; });
    chosen = std::size_t(after - discs_.begin()) - 1;
    const Disc& d = discs_[chosen];
    const Vec2 p = disc_point((u - d.below) / d.share, v);
    x = dot(d.centre, across) + p.x * d.radius;
    y = dot(d.centre, up) + p.y * d.radius;
  }
  for (std::size_t k = 0; k < discs_.size(); ++k) {
    const double dx = x - dot(discs_[k].centre, across), dy = y - dot(discs_[k].centre, up);
    // Of its own disc, whatever rounding says of the rim.
    if (k == chosen || dx * dx + dy * dy < discs_[k].radius * discs_[k].radius) density += discs_[k].gain;
  }
  Start start;
  start.origin = scene_centre_ + axes.to_world({float(x), float(y), -float(scene_radius_)});
  // No geometry lies beside the scene's disc: what starts there is not part of the flux, and black.
  const bool beside = chosen < discs_.size() && x * x + y * y > scene_radius_ * scene_radius_;
  start.flux = beside ? 0 : 1 / density;
  return start;
}

bool Aim::holds(Vec3 point) const {
  const Vec3d from = Vec3d(point) - Vec3d(scene_centre_);
  return std::ranges::any_of(discs_, [&](const Disc& d) {
    const Vec3d to = from - d.centre;
    return dot(to, to) < d.radius * d.radius;
  });
}

}  // namespace tempolux
