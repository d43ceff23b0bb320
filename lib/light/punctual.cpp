#include "lib/light/punctual.h"

#include <algorithm>
#include <cmath>

#include "lib/core/frame.h"
#include "lib/core/pi.h"
#include "lib/core/sampling.h"

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

Rgbd punctual_flux(const PunctualLight& light, double disc_radius) {
  const Rgbd intensity{light.intensity};
  switch (light.kind) {
    case PunctualLight::Kind::point: return intensity * (4 * kPiD);
    case PunctualLight::Kind::spot: return intensity * SpotProfile(light).solid_angle();
    case PunctualLight::Kind::directional: return intensity * (kPiD * disc_radius * disc_radius);
  }
  return {};
}

Vec3 sample_punctual_direction(const PlacedLight& placed, double u1, double u2) {
  double omc = 2 * u1;
  if (placed.light.kind == PunctualLight::Kind::spot) omc = SpotProfile(placed.light).sample_one_minus_cos(u1);
  const double r = std::sqrt(std::max(0.0, omc * (2 - omc))), phi = 2 * kPiD * u2;
  return normalize(
      Frame(placed.direction).to_world({float(r * std::cos(phi)), float(r * std::sin(phi)), float(1 - omc)}));
}

}  // namespace tempolux
