// lib/light/punctual.h -- point, spot and directional lights of KHR_lights_punctual: falloff, size, flux, light samples
// and emission of photons.
//
// With a size (LampSize), a point or spot light of intensity I(w) in the direction of travel w is a sphere of radius r
// whose whole surface has the radiance L(w) = I(w) / (pi r^2). Seen along w the sphere is a disc of the area pi r^2, so
// its intensity is I(w): size changes neither flux nor far light. At the distance d > r the sphere fills a cone with
// sin = r / d, and a surface that faces a point light receives pi L sin^2 = I / d^2, as without a size. Inside the
// sphere the radiance L comes from all directions. A directional light of irradiance E and angular diameter 2 a is a
// disc of directions with the radiance E / (pi sin^2 a), so a surface that faces the disc receives E.
#pragma once

#include <array>

#include "lib/core/vec.h"
#include "lib/light/aim.h"
#include "lib/light/light_sample.h"
#include "lib/light/light_tree.h"
#include "lib/scene/at_frame.h"

namespace tempolux {

/// Intensity of a spot at angle t from its axis: I inside the inner cone; I s^2 outside, with s = (cos t - cos outer) /
/// (cos inner - cos outer), clamped to [0, 1]. This is the falloff of KHR_lights_punctual without its floor of 0.001 in
/// the denominator, which would dim the axis of cones narrower than 2.6 degrees. Angles are held as 1 - cos, which
/// keeps its digits for narrow cones.
struct SpotProfile {
  double inner = 0, outer = 0;  ///< 1 - cos of the half angles; inner <= outer

  /// The profile of a light of kind spot.
  explicit SpotProfile(const PunctualLight& light);
  /// s^2 [1] at one_minus_cos = 1 - cos t.
  double falloff(double one_minus_cos) const;
  /// Integral of s^2 over the sphere [sr]: 2 pi (inner + (outer - inner) / 3).
  double solid_angle() const;
  /// Draws 1 - cos t in proportion to the emitted light; u in [0, 1), where 0 is the axis.
  double sample_one_minus_cos(double u) const;
};

/// A point, spot or directional light at a frame, as one of the kinds of lights (light_sample.h). A ray does not meet
/// it, so it has no pdf_solid_angle().
struct PunctualSource {
  const PlacedLight& placed;
  const Aim& aim;  ///< where photons of a directional light start; also holds the radius of the scene sphere

  /// Flux [W]; of a directional light, the flux through the scene sphere's disc: 2 / (1 + cos a) E pi R^2, since each
  /// direction of the light's disc has a scene disc of its own.
  Rgbd flux() const { return flux(placed.light, aim.scene_radius()); }
  static Rgbd flux(const PunctualLight& light, double disc_radius);
  bool emits() const { return max_component(placed.light.intensity) > 0; }
  bool distant() const { return placed.light.distant(); }
  /// Bounds of a point or spot light for the light tree, which lies in no closed part.
  LightBounds bounds(const Box3& backs_within = {}) const;
  /// Fills the sample of a light that was chosen with this probability P. False if no light reaches the point. u in
  /// [0, 1) is used if the light has a size: it draws a direction uniform in the solid angle that the light fills, and
  /// facing_irradiance is that of the whole light:
  ///     outside of a sphere   2 I(w) / (d^2 (1 + cos) P) with sin = r / d, which goes to I / d^2 for a small r
  ///     inside of a sphere    4 I(w) / (r^2 P)
  ///     directional           2 E / ((1 + cos a) P)
  bool sample(Vec3 point, Vec2 u, double probability, LightSample& s) const;
  /// Emits a photon whose flux is set: u0 and u[1] give the direction, or the start of a directional light; u[2] and
  /// u[3] the start on a sphere, or the direction in the disc of a directional light. A photon of a sphere starts
  /// uniformly on the disc that the sphere shows in its direction, so its directions have the pdf cos / pi around the
  /// sphere's normal. PhotonEmission::chord lets them light what lies inside of the sphere.
  void emit(double u0, const std::array<double, 4>& u, double probability, PhotonEmission& e) const;

 private:
  [[gnu::noinline]] bool sample_sized(Vec3 point, Vec2 u, double probability, LightSample& s) const;
  [[gnu::noinline]] void emit_sized(double u0, const std::array<double, 4>& u, PhotonEmission& e) const;
};

/// Unit direction in which a point or spot light emits a photon, from u1 and u2 in [0, 1). The pdf is in proportion to
/// intensity: uniform over the sphere for a point light.
Vec3 sample_punctual_direction(const PlacedLight& placed, double u1, double u2);

}  // namespace tempolux
