// lib/light/aim.h -- aims the photons of sun and sky at the places that cameras see.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "lib/core/pi.h"
#include "lib/core/statistics.h"
#include "lib/core/vec.h"

namespace tempolux {

/// A sphere around surfaces that matter to the picture. Its share of the photons is in proportion to its weight.
struct AimSphere {
  Vec3d centre{};     ///< of the sphere; scene space, m
  double radius = 0;  ///< m, above 0
  double weight = 0;  ///< above 0; Aim divides by the sum of all weights

  bool holds(Vec3d point) const { return length2(point - centre) < radius * radius; }
};

/// Start points of parallel light. A photon starts with probability kUniform uniformly on a disc of the scene sphere's
/// radius R in front of the scene. Else it chooses sphere k with probability w_k and starts uniformly on the disc of
/// radius r_k that the sphere covers, seen along the light. The constructor adds larger spheres around all given ones,
/// each twice as wide as the one before, up to the scene's; together they have the share kAround. Openings are spheres
/// that light passes on its way to what is seen; larger spheres are added around them, too. If spheres and openings are
/// given, the given spheres and the larger ones around them keep half of their shares, and the openings and those
/// around them get the other half. If openings alone are given, they get the share 1 - kUniform. Bounces are not aimed
/// at openings. The pdf [1/m^2] of a start point sums over all ways to choose the point:
///     p = kUniform / (pi R^2) + (1 - kUniform) sum_k w_k [disc k holds the point] / (pi r_k^2)
/// A photon's flux is divided by p, so the expected light does not depend on the spheres or their weights. Flux is at
/// most 1 / kUniform times the flux without spheres, so badly placed spheres cost little.
class Aim {
 public:
  static constexpr double kUniform = kUnguidedShare, kAround = kUnguidedShare;  ///< derived in docs/methods/aim.md

  /// No aim: empty().
  Aim() = default;
  /// Radii and weights must be above 0. Without spheres and openings, or without a scene, the aim is empty. Scene
  /// space, m.
  Aim(std::span<const AimSphere> spheres, std::span<const AimSphere> openings, Vec3 scene_centre, double scene_radius);

  /// The scene sphere's radius [m], and the area [m^2] of its disc, through which all light from outside comes.
  double scene_radius() const { return scene_radius_; }
  double disc_area() const { return kPiD * scene_radius_ * scene_radius_; }
  /// m; from any point of the scene sphere this distance reaches its surface.
  float distance_beyond() const { return float(scene_radius_ > 0 ? 2 * scene_radius_ : 1); }
  /// m; closer to a punctual light its irradiance no longer grows, since it must stay finite.
  double least_distance() const { return 1e-6 * scene_radius_; }
  bool empty() const { return discs_.empty(); }  ///< true if photons are not aimed
  std::size_t size() const { return given_; }    ///< number of the given spheres

  struct Start {
    Vec3 origin{};    ///< of the photon; scene space, in front of the scene sphere
    double flux = 0;  ///< flux as a multiple of an unaimed photon's flux: 1 / (p pi R^2); 0 outside the scene's disc
  };
  /// Start point of light that travels along `travel` (unit). u and v are in [0, 1). u chooses the disc; its place
  /// inside the disc's part of [0, 1) is the first coordinate on the disc, v the second. Neighbouring numbers give
  /// neighbouring points. The mean of flux over u and v is 1, also where spheres reach out of the scene sphere. Without
  /// spheres the start is uniform on the scene's disc.
  Start start(Vec3 travel, double u, double v) const;
  /// p pi R^2 of light that travels along `travel` (unit) through a point inside the scene's sphere: 1 / Start::flux.
  double density(Vec3 point, Vec3 travel) const;

  /// True if one of the given spheres holds the point (scene space).
  bool holds(Vec3 point) const;

  /// True if bounces at this place (scene space) may be aimed at given spheres. Targets are the spheres that are
  /// kMuchSmaller times smaller than the smallest given sphere that holds the place; if none holds it, all spheres.
  bool aims_from(Vec3 place) const;
  /// A large sphere holds a wide ground that a window shows, and small spheres hold the room. Light that the ground
  /// reflects must find the window, so the factor must be below the ratio of these radii. It must be above the ratio of
  /// the spheres of one room, since bounces inside a room find its other spheres anyway: the smallest cell of a room is
  /// a quarter of the distance seen.
  static constexpr double kMuchSmaller = 8;

  /// A direction from a place into one of the spheres that aims_from() allows. The sphere is chosen by weight; the
  /// direction is uniform over the solid angle that the sphere covers.
  struct Way {
    Vec3 direction;              ///< unit
    double pdf_solid_angle = 0;  ///< [1/sr]; sums over all spheres that lie in this direction
  };
  /// u.x chooses the sphere and gives the angle to the cone's axis, u.y the angle around the axis. Must not be called
  /// unless aims_from(place).
  Way towards(Vec3 place, Vec2 u) const;
  /// pdf [1/sr] with which towards() gives this direction (unit).
  double pdf_solid_angle(Vec3 place, Vec3 direction) const;
  /// Share of the bounces outside the spheres that go towards a sphere. Derived in docs/methods/aim.md.
  static constexpr float kTowards = 0.5f;

 private:
  struct Disc {
    Vec3d centre;  // relative to the scene sphere's centre, m
    double radius;
    double below;  // probability of choosing the scene's disc or an earlier disc: kUniform + sum of their shares
    double share;  // probability of this disc
    double gain;   // share R^2 / r^2 with the scene's radius R: term of the disc in p pi R^2 (Start::flux)

    bool holds(Vec3d point) const { return length2(point - centre) < radius * radius; }
  };
  void add_given(std::span<const AimSphere> spheres, double share);
  void add_all(std::span<const AimSphere> spheres, double share);
  void add(Vec3d centre, double radius, double share);
  double density(double x, double y, Vec3d across, Vec3d up, std::size_t chosen) const;
  std::span<const Disc> given() const { return std::span(discs_).first(given_); }
  double largest_target(Vec3d place) const;
  double pdf_solid_angle(Vec3d place, Vec3 direction, std::size_t chosen, double largest) const;
  std::vector<Disc> discs_;  ///< the given spheres come first, openings last
  std::size_t given_ = 0;
  double smallest_ = INFINITY;  ///< m: least radius of the given spheres
  Vec3 scene_centre_{};
  double scene_radius_ = 0;
};

}  // namespace tempolux
