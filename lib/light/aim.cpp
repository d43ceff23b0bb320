// lib/light/aim.cpp -- start points of parallel light, drawn from a mixture of discs.
#include "lib/light/aim.h"

#include <algorithm>
#include <cmath>

#include "lib/core/check.h"
#include "lib/core/frame.h"
#include "lib/core/pi.h"
#include "lib/core/sampling.h"

namespace tempolux {
namespace {

Vec2 disc_point(double u, double v) {
  const auto below_one = [](double x) { return std::min(float(x), kOneMinusEpsilon); };
  return sample_disc_concentric({below_one(u), below_one(v)});
}

/// 1 - cosine of half the angle that a sphere covers, seen from a point outside the sphere. Small angles keep all
/// digits.
double one_minus_cos(double radius, Vec3d to_centre) {
  const double sine2 = std::min(1.0, radius * radius / dot(to_centre, to_centre));
  return sine2 / (1 + std::sqrt(1 - sine2));
}

double sum_of_weights(std::span<const AimSphere> spheres) {
  double sum = 0;
  for (const AimSphere& sphere : spheres) {
    TEMPOLUX_CHECK(sphere.radius > 0 && sphere.weight > 0);
    sum += sphere.weight;
  }
  return sum;
}

}  // namespace

Aim::Aim(std::span<const AimSphere> spheres, std::span<const AimSphere> openings, Vec3 scene_centre,
         double scene_radius)
    : scene_centre_(scene_centre), scene_radius_(scene_radius) {
  if (!(scene_radius > 0)) return;
  const double aimed = 1 - kUniform, of_openings = openings.empty() ? 0 : spheres.empty() ? aimed : aimed / 2;
  add_given(spheres, aimed - of_openings);
  add_all(openings, of_openings);
}

void Aim::add_given(std::span<const AimSphere> spheres, double share) {
  add_all(spheres, share);
  given_ = spheres.size();
  for (const AimSphere& sphere : spheres) smallest_ = std::min(smallest_, sphere.radius);
}

/// Adds spheres and the larger spheres around them. Both have the same part of the share as spheres without openings.
void Aim::add_all(std::span<const AimSphere> spheres, double share) {
  if (spheres.empty()) return;
  const double sum = sum_of_weights(spheres);
  double squares = 0;
  Vec3d middle;
  for (const AimSphere& sphere : spheres) middle = middle + sphere.centre * sphere.weight;
  middle = middle / sum;
  for (const AimSphere& sphere : spheres) {
    const Vec3d off = sphere.centre - middle;
    squares += sphere.weight / sum * (dot(off, off) + sphere.radius * sphere.radius);
  }
  std::vector<double> around;  // radii
  for (double radius = 2 * std::sqrt(squares); radius <= scene_radius_; radius *= 2) around.push_back(radius);
  const double of_around = around.empty() ? 0 : share * kAround / (1 - kUniform), aimed = share - of_around;
  for (const AimSphere& sphere : spheres) add(sphere.centre, sphere.radius, aimed * sphere.weight / sum);
  for (const double radius : around) add(middle, radius, of_around / double(around.size()));
}

/// Adds a disc that is chosen with probability `share`.
void Aim::add(Vec3d centre, double radius, double share) {
  const double ratio = scene_radius_ / radius,
               below = discs_.empty() ? kUniform : discs_.back().below + discs_.back().share;
  discs_.push_back({centre - Vec3d(scene_centre_), radius, below, share, share * ratio * ratio});
}

Aim::Start Aim::start(Vec3 travel, double u, double v) const {
  const Frame axes(travel);
  if (empty()) {
    const Vec2 disc = disc_point(u, v);
    const float r = float(scene_radius_);
    return {scene_centre_ + axes.to_world({disc.x * r, disc.y * r, -r}), 1};
  }
  const Vec3d across(axes.to_world({1, 0, 0})), up(axes.to_world({0, 1, 0}));
  double x, y;
  std::size_t chosen = discs_.size();
  if (u < kUniform) {
    const Vec2 p = disc_point(u / kUniform, v);
    x = p.x * scene_radius_;
    y = p.y * scene_radius_;
  } else {
    const auto after =
        std::upper_bound(discs_.begin(), discs_.end(), u, [](double at, const Disc& d) { return at < d.below; });
    chosen = std::size_t(after - discs_.begin()) - 1;
    const Disc& d = discs_[chosen];
    const Vec2 p = disc_point((u - d.below) / d.share, v);
    x = dot(d.centre, across) + p.x * d.radius;
    y = dot(d.centre, up) + p.y * d.radius;
  }
  Start start;
  start.origin = scene_centre_ + axes.to_world({float(x), float(y), -float(scene_radius_)});
  // There is no geometry outside the scene's disc: photons that start there carry no flux.
  const bool beside = chosen < discs_.size() && x * x + y * y > scene_radius_ * scene_radius_;
  start.flux = beside ? 0 : 1 / density(x, y, across, up, chosen);
  return start;
}

double Aim::density(Vec3 point, Vec3 travel) const {
  const Frame axes(travel);
  const Vec3d across(axes.to_world({1, 0, 0})), up(axes.to_world({0, 1, 0})),
      from = Vec3d(point) - Vec3d(scene_centre_);
  return discs_.empty() ? 1 : density(dot(from, across), dot(from, up), across, up, discs_.size());
}

/// x, y [m]: place on the scene's disc with the axes `across` and `up`. `chosen`: the disc that the place was drawn on.
/// The place counts as inside this disc, although rounding may put it just outside the rim.
double Aim::density(double x, double y, Vec3d across, Vec3d up, std::size_t chosen) const {
  double density = kUniform;
  for (std::size_t k = 0; k < discs_.size(); ++k) {
    const double dx = x - dot(discs_[k].centre, across), dy = y - dot(discs_[k].centre, up);
    if (k == chosen || dx * dx + dy * dy < discs_[k].radius * discs_[k].radius) density += discs_[k].gain;
  }
  return density;
}

bool Aim::holds(Vec3 point) const {
  const Vec3d from = Vec3d(point) - Vec3d(scene_centre_);
  return std::ranges::any_of(given(), [&](const Disc& d) { return d.holds(from); });
}

/// Radius [m] up to which spheres are targets from a place, which is relative to the scene's centre.
double Aim::largest_target(Vec3d place) const {
  double own = INFINITY;
  for (const Disc& d : given())
    if (d.holds(place)) own = std::min(own, d.radius);
  return own / kMuchSmaller;
}

bool Aim::aims_from(Vec3 place) const {
  return given_ > 0 && smallest_ <= largest_target(Vec3d(place) - Vec3d(scene_centre_));
}

Aim::Way Aim::towards(Vec3 place, Vec2 u) const {
  const Vec3d from = Vec3d(place) - Vec3d(scene_centre_);
  const double largest = largest_target(from);
  double left = 0;
  for (const Disc& d : given()) left += d.radius <= largest ? d.share : 0;
  left *= double(u.x);
  std::size_t chosen = given_;
  for (std::size_t k = 0; k < given_; ++k) {
    if (!(discs_[k].radius <= largest)) continue;
    if (chosen != given_) left -= discs_[chosen].share;
    chosen = k;
    if (left < discs_[k].share) break;
  }
  const Vec3d to = discs_[chosen].centre - from;
  // The direction is uniform over the cone, so 1 - cos of its angle to the axis is uniform.
  const double off = std::min(left / discs_[chosen].share, 1.0) * one_minus_cos(discs_[chosen].radius, to),
               phi = 2 * kPiD * double(u.y);
  const double across = std::sqrt(off * (2 - off));
  const Frame axes(Vec3(to * (1 / length(to))));
  const Vec3 direction =
      normalize(axes.to_world({float(across * std::cos(phi)), float(across * std::sin(phi)), float(1 - off)}));
  return {direction, pdf_solid_angle(from, direction, chosen, largest)};
}

double Aim::pdf_solid_angle(Vec3 place, Vec3 direction) const {
  const Vec3d from = Vec3d(place) - Vec3d(scene_centre_);
  return pdf_solid_angle(from, direction, discs_.size(), largest_target(from));
}

/// `chosen` is the sphere towards which the direction was drawn: it counts even where rounding puts the direction just
/// outside the rim. `place` is relative to the scene's centre; `largest`: largest_target(place).
double Aim::pdf_solid_angle(Vec3d place, Vec3 direction, std::size_t chosen, double largest) const {
  double pdf = 0, shares = 0;
  for (std::size_t k = 0; k < given_; ++k) {
    if (!(discs_[k].radius <= largest)) continue;
    shares += discs_[k].share;
    const Vec3d to = discs_[k].centre - place, aside = cross(to, Vec3d(direction));
    if (k == chosen || (dot(to, Vec3d(direction)) > 0 && length2(aside) < discs_[k].radius * discs_[k].radius))
      pdf += discs_[k].share / (2 * kPiD * one_minus_cos(discs_[k].radius, to));
  }
  return shares > 0 ? pdf / shares : 0;
}

}  // namespace tempolux
