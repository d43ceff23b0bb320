#include "lib/light/punctual.h"

#include <algorithm>
#include <cmath>

#include "lib/core/frame.h"
#include "lib/core/pi.h"
#include "lib/core/sampling.h"
#include "lib/light/sky_source.h"

namespace tempolux {
namespace {

double one_minus_cos(double angle) {
  const double s = std::sin(angle / 2);
  return 2 * s * s;
}

/// Directions around an axis, uniform in the solid angle 2 pi end [sr].
struct Cone {
  double end;  ///< 1 - cos a, where a is the angle between axis and edge; 2: the cone holds all directions

  /// 1 - cosine of the angle between the axis and the direction that a point of the unit disc stands for.
  double one_minus_cos(Vec2 disc) const { return end * std::min(1.0, length2(disc)); }
  /// The direction (unit). A cone so narrow that floats cannot resolve it gives the axis.
  Vec3 direction(Vec3 axis, Vec2 disc) const {
    const double omc = one_minus_cos(disc), across = std::sqrt(end * std::max(0.0, 2 - omc));
    return normalize(
        Frame(axis).to_world({float(across * double(disc.x)), float(across * double(disc.y)), float(1 - omc)}));
  }

 private:
  static double length2(Vec2 v) { return double(v.x) * double(v.x) + double(v.y) * double(v.y); }
};

/// The disc of directions of a directional light.
Cone disc_of(const LampSize& size) { return {one_minus_cos(0.5 * double(size.angle_rad))}; }

}  // namespace

SpotProfile::SpotProfile(const PunctualLight& light)
    : inner(one_minus_cos(light.inner_cone_rad)), outer(one_minus_cos(light.outer_cone_rad)) {
  inner = std::min(inner, outer);
}

double SpotProfile::falloff(double one_minus_cos) const {
  if (one_minus_cos <= inner) return 1;
  if (!(one_minus_cos < outer)) return 0;
  const double s = (outer - one_minus_cos) / (outer - inner);
  return s * s;
}

double SpotProfile::solid_angle() const { return 2 * kPiD * (inner + (outer - inner) / 3); }

double SpotProfile::sample_one_minus_cos(double u) const {
  const double x = u * (inner + (outer - inner) / 3);
  if (x < inner || !(outer > inner)) return std::min(x, outer);
  // The integral of s^2 from t to the outer cone is 2 pi (outer - inner) s^3 / 3.
  const double outside = std::max(0.0, 1 - (x - inner) / ((outer - inner) / 3));
  return outer - (outer - inner) * std::cbrt(outside);
}

Rgbd PunctualSource::flux(const PunctualLight& light, double disc_radius) {
  const Rgbd intensity{light.intensity};
  switch (light.kind) {
    case PunctualLight::Kind::point: return intensity * (4 * kPiD);
    case PunctualLight::Kind::spot: return intensity * SpotProfile(light).solid_angle();
    case PunctualLight::Kind::directional:
      return intensity * (kPiD * disc_radius * disc_radius / (1 - 0.5 * disc_of(light.size).end));
  }
  return {};
}

LightBounds PunctualSource::bounds(const Box3&) const {
  LightBounds b;
  const float r = placed.light.size.radius_m;
  const Vec3 reach{r, r, r};
  b.box.add(placed.position - reach);
  b.box.add(placed.position + reach);
  b.axis = placed.direction;
  b.add_punctual(max_component(placed.light.intensity));
  b.cos_spread = -1;
  if (placed.light.kind == PunctualLight::Kind::spot) {
    // The normals fill the inner cone. A direction of the outer cone's edge makes the angle outer - inner with the
    // closest of them.
    b.cos_spread = std::cos(std::min(placed.light.inner_cone_rad, placed.light.outer_cone_rad));
    b.cos_reach = std::max(0.0f, std::cos(placed.light.outer_cone_rad - std::acos(b.cos_spread)));
  }
  return b;
}

bool PunctualSource::sample(Vec3 point, Vec2 u, double probability, LightSample& s) const {
  s.only_sampled = true;
  if (placed.light.has_size()) [[unlikely]]
    return sample_sized(point, u, probability, s);
  if (placed.light.distant()) {
    s.wi = -placed.direction;
    s.position = point + s.wi * aim.distance_beyond();
    s.facing_irradiance = Rgb(Rgbd(placed.light.intensity) / probability);
    s.distant = true;
    return true;
  }
  const Vec3d to = Vec3d(placed.position) - Vec3d(point);
  const double distance = length(to);
  if (!(distance > 0)) return false;
  const double nearest = std::max(distance, aim.least_distance());
  s.wi = Vec3(to / distance);
  s.position = placed.position;
  double falloff = 1;
  if (placed.light.kind == PunctualLight::Kind::spot)
    falloff = SpotProfile(placed.light).falloff(0.5 * length2(Vec3d(placed.direction) + to / distance));
  s.facing_irradiance = Rgb(Rgbd(placed.light.intensity) * (falloff / (nearest * nearest * probability)));
  return falloff > 0;
}

/// sample() of a light with a size. No formula has a difference of nearly equal numbers or divides by a small size.
bool PunctualSource::sample_sized(Vec3 point, Vec2 u, double probability, LightSample& s) const {
  const Vec2 disc = sample_disc_concentric(u);
  if (placed.light.distant()) {
    const Cone sun = disc_of(placed.light.size);
    s.wi = sun.direction(-placed.direction, disc);
    s.position = point + s.wi * aim.distance_beyond();
    s.facing_irradiance = Rgb(Rgbd(placed.light.intensity) / ((1 - 0.5 * sun.end) * probability));
    s.distant = true;
    return true;
  }
  const Vec3d to = Vec3d(placed.position) - Vec3d(point);
  const double distance = length(to), r = double(placed.light.size.radius_m);
  const bool outside = distance > r;
  const double sine2 = outside ? r / distance * (r / distance) : 1, cosine = std::sqrt(1 - sine2);
  const Cone cone{outside ? sine2 / (1 + cosine) : 2};
  s.wi = cone.direction(distance > 0 ? Vec3(to / distance) : placed.direction, disc);
  const double omc = cone.one_minus_cos(disc), along = distance * (1 - omc),
               half_chord = std::sqrt(std::max(0.0, r * r - distance * distance * omc * (2 - omc)));
  s.position = Vec3(Vec3d(point) + Vec3d(s.wi) * (outside ? along - half_chord : along + half_chord));
  double falloff = 1;
  if (placed.light.kind == PunctualLight::Kind::spot)
    falloff = SpotProfile(placed.light).falloff(0.5 * length2(Vec3d(placed.direction) + Vec3d(s.wi)));
  const double nearest = std::max({distance, r, aim.least_distance()}), gain = outside ? 2 / (1 + cosine) : 4;
  s.facing_irradiance = Rgb(Rgbd(placed.light.intensity) * (gain * falloff / (nearest * nearest * probability)));
  return falloff > 0;
}

void PunctualSource::emit(double u0, const std::array<double, 4>& u, double, PhotonEmission& e) const {
  if (placed.light.has_size()) [[unlikely]]
    return emit_sized(u0, u, e);
  if (placed.light.distant()) {
    e.travel = placed.direction;
    start_distant(aim, u0, u[1], Rgbd(e.flux), e);
    return;
  }
  // A light without size has one place, so the first two numbers give the direction.
  e.origin = placed.position;
  e.travel = sample_punctual_direction(placed, u0, u[1]);
}

void PunctualSource::emit_sized(double u0, const std::array<double, 4>& u, PhotonEmission& e) const {
  const auto below_one = [](double x) { return std::min(float(x), kOneMinusEpsilon); };
  const Vec2 disc = sample_disc_concentric({below_one(u[2]), below_one(u[3])});
  if (placed.light.distant()) {
    e.travel = disc_of(placed.light.size).direction(placed.direction, disc);
    start_distant(aim, u0, u[1], Rgbd(e.flux), e);
    return;
  }
  e.travel = sample_punctual_direction(placed, u0, u[1]);
  const float height = std::sqrt(std::max(0.0f, 1 - disc.x * disc.x - disc.y * disc.y));
  e.normal = normalize(Frame(e.travel).to_world({disc.x, disc.y, height}));
  e.origin = Vec3(Vec3d(placed.position) + Vec3d(e.normal) * double(placed.light.size.radius_m));
  e.chord = 2 * placed.light.size.radius_m * height;
}

Vec3 sample_punctual_direction(const PlacedLight& placed, double u1, double u2) {
  double omc = 2 * u1;
  if (placed.light.kind == PunctualLight::Kind::spot) omc = SpotProfile(placed.light).sample_one_minus_cos(u1);
  const double r = std::sqrt(std::max(0.0, omc * (2 - omc))), phi = 2 * kPiD * u2;
  return normalize(
      Frame(placed.direction).to_world({float(r * std::cos(phi)), float(r * std::sin(phi)), float(1 - omc)}));
}

}  // namespace tempolux
