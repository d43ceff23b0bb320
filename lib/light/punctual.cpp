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
    case PunctualLight::Kind::directional: return intensity * (kPiD * disc_radius * disc_radius);
  }
  return {};
}

LightBounds PunctualSource::bounds(const Box3&) const {
  LightBounds b;
  b.box.add(placed.position);
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

bool PunctualSource::sample(Vec3 point, double probability, LightSample& s) const {
  s.delta = true;
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
  // Irradiance must stay finite: closer than a millionth of the scene's radius it no longer grows.
  const double nearest = std::max(distance, 1e-6 * aim.scene_radius());
  s.wi = Vec3(to / distance);
  s.position = placed.position;
  double falloff = 1;
  if (placed.light.kind == PunctualLight::Kind::spot)
    falloff = SpotProfile(placed.light).falloff(0.5 * length2(Vec3d(placed.direction) + to / distance));
  s.facing_irradiance = Rgb(Rgbd(placed.light.intensity) * (falloff / (nearest * nearest * probability)));
  return falloff > 0;
}

void PunctualSource::emit(double u0, const std::array<double, 4>& u, double, PhotonEmission& e) const {
  if (placed.light.distant()) {
    e.travel = placed.direction;
    start_distant(aim, u0, u[1], Rgbd(e.flux), e);
    return;
  }
  // A point light has no extent, so the first two numbers give the direction.
  e.origin = placed.position;
  e.travel = sample_punctual_direction(placed, u0, u[1]);
}

Vec3 sample_punctual_direction(const PlacedLight& placed, double u1, double u2) {
  double omc = 2 * u1;
  if (placed.light.kind == PunctualLight::Kind::spot) omc = SpotProfile(placed.light).sample_one_minus_cos(u1);
  const double r = std::sqrt(std::max(0.0, omc * (2 - omc))), phi = 2 * kPiD * u2;
  return normalize(
      Frame(placed.direction).to_world({float(r * std::cos(phi)), float(r * std::sin(phi)), float(1 - omc)}));
}

}  // namespace tempolux
