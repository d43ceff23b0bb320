// lib/light/aim.h -- photons of sun and sky, sent where cameras look.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "lib/core/vec.h"

namespace tempolux {

/// A ball that holds things worth lighting, and its share of the photons.
struct AimSphere {
  Vec3d centre{};     ///< scene space, m
  double radius = 0;  ///< m, above 0
  double weight = 0;  ///< above 0; Aim divides by the sum
};

/// Where parallel light enters the scene. Without spheres its photons start uniformly on a disc of the scene sphere's
/// radius R, in front of the scene. With them a photon does so with probability kUniform only; else it chooses sphere k
/// with probability w_k and starts uniformly on the disc of radius r_k that the sphere covers in the light's direction.
/// To the given spheres come those around all of them, each twice as wide as the one before, up to the scene's; they
/// share kAround.
///
/// The density [1/m^2] of starting at a place is the sum over all ways to get there:
///     p = kUniform / (pi R^2) + (1 - kUniform) sum_k w_k [disc k holds it] / (pi r_k^2)
/// A photon's flux is divided by it, so any spheres and weights give the same light in the mean. Flux is at most
/// 1 / kUniform times what it is without spheres: wrong spheres do little harm.
class Aim {
 public:
  static constexpr double kUniform = 0.25, kAround = 0.25;  ///< docs/methods/aim.md

  Aim() = default;
  Aim(std::span<const AimSphere> spheres, Vec3 scene_centre, double scene_radius);

  bool empty() const { return discs_.empty(); }
  std::size_t size() const { return given_; }  ///< spheres that were given

  struct Start {
    Vec3 origin{};    ///< scene space, in front of the scene sphere
    double flux = 0;  ///< 1 / (p pi R^2): times what a photon of the uniform disc carries; 0 beside the scene's disc
  };
  /// For light that flies along `travel` (unit). u, v in [0, 1): u chooses the disc and, stretched, is the first
  /// coordinate on it, v the second: neighbours stay neighbours. The mean of flux over u, v is 1, also where spheres
  /// reach beyond the scene sphere. Only if not empty().
  Start start(Vec3 travel, double u, double v) const;

  /// Does some of the given spheres hold the point (scene space)?
  bool holds(Vec3 point) const;

  /// A direction from a place outside of all given spheres into one of them: chosen by weight, uniform over the solid
  /// angle that it covers.
  struct Way {
    Vec3 direction;      ///< unit
    double density = 0;  ///< 1/sr, by all spheres that lie in this direction
  };
  /// u.x chooses the sphere and, stretched, is the first coordinate in it. Only if not empty() and not holds(place).
  Way towards(Vec3 place, Vec2 u) const;
  /// Density of towards() [1/sr] in a direction (unit).
  double density_towards(Vec3 place, Vec3 direction) const;
  static constexpr float kTowards = 0.5f;  ///< of the bounces outside of the spheres: docs/methods/aim.md

 private:
  struct Disc {
    Vec3d centre;  // from the scene sphere's centre
    double radius, below, share,
        gain;  // shares of those before; share; share R^2 / r^2, (1 - kUniform) included in all
  };
  void add(Vec3d centre, double radius, double share);
  double density_towards(Vec3d place, Vec3 direction, std::size_t chosen) const;
  std::vector<Disc> discs_;  ///< those of the given spheres first
  std::size_t given_ = 0;
  double given_share_ = 0;  ///< of all discs
  Vec3 scene_centre_{};
  double scene_radius_ = 0;
};

}  // namespace tempolux
