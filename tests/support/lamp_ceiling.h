// tests/support/lamp_ceiling.h -- a lamp close to a ceiling, whose spot is smaller than the spacing of the points.
#pragma once

#include <cmath>
#include <vector>

#include "lib/irradcache/points.h"
#include "tests/support/scenes.h"

namespace tempolux::test {

/// A ceiling of 40 m at height 1 m, with a point lamp of 1 W/sr at a distance d below it. Points lie half a metre apart
/// around the place above the lamp, and none lies directly above the lamp.
struct Ceiling {
  static constexpr float kReflectance = 0.5f, kSpacing = 0.5f;
  HandMadeScene scene;
  std::vector<IrradiancePoint> points;
  double d;

  explicit Ceiling(double distance) : d(distance) {
    scene.add_quad({-20, 1, -20}, {20, 1, -20}, {20, 1, 20}, {-20, 1, 20}, matte(Rgb(kReflectance)));
    scene.add_point_light({0, float(1 - d), 0}, Rgb(1.0f));
    for (int i = -6; i < 6; ++i)
      for (int j = -6; j < 6; ++j) {
        IrradiancePoint point;
        point.position = {(float(i) + 0.5f) * kSpacing, 1, (float(j) + 0.5f) * kSpacing};
        point.normal = {0, -1, 0};
        const double r2 = double(point.position.x * point.position.x + point.position.z * point.position.z);
        point.direct = Rgb(float(d / std::pow(r2 + d * d, 1.5)));
        points.push_back(point);
      }
  }
  /// Irradiance at (x, 0, 0), normal up: the integral over the lamp's directions (phi from the ceiling's normal, psi),
  /// with a flux of sin phi dphi dpsi each, of reflectance / pi cos cos / l^2.
  double exact(double x) const {
    return exact(x, [](double, double) { return true; });
  }
  /// The light from the places (x, z) of the ceiling with sees(x, z).
  template <class Sees>
  double exact(double x, const Sees& sees) const {
    constexpr int n = 400;
    double sum = 0;
    for (int i = 0; i < n; ++i)
      for (int j = 0; j < n; ++j) {
        const double phi = (i + 0.5) / n * M_PI / 2, psi = (j + 0.5) / n * 2 * M_PI, r = d * std::tan(phi);
        const double dx = r * std::cos(psi) - x, dz = r * std::sin(psi), l2 = dx * dx + dz * dz + 1;
        if (!sees(r * std::cos(psi), r * std::sin(psi))) continue;
        sum += std::sin(phi) * (M_PI / 2 / n) * (2 * M_PI / n) / (l2 * l2);
      }
    return double(kReflectance) / M_PI * sum;
  }
};

}  // namespace tempolux::test
