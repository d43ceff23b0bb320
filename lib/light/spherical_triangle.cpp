#include "lib/light/spherical_triangle.h"

#include <algorithm>
#include <cmath>

namespace tempolux {
namespace {

Vec3d unit(Vec3d v) { return v * (1 / std::sqrt(std::max(1e-300, length2(v)))); }
/// The component of v perpendicular to the unit vector w, normalised.
Vec3d reject(Vec3d v, Vec3d w) { return unit(v - w * dot(v, w)); }

}  // namespace

SphericalTriangle as_seen(Vec3 to0, Vec3 to1, Vec3 to2) {
  return {unit(Vec3d(to0)), unit(Vec3d(to1)), unit(Vec3d(to2))};
}

Vec3d sample_spherical_triangle(const SphericalTriangle& t, double solid_angle, Vec2 u) {
  const auto& [a, b, c] = t;
  const Vec3d toward_b = reject(b, a), toward_c = reject(c, a);
  const double cos_alpha = std::clamp(dot(toward_b, toward_c), -1.0, 1.0);
  const double sin_alpha = length(cross(toward_b, toward_c));
  // phi = part of the area - alpha; sine and cosine of the difference
  const double part = u.x * solid_angle, sin_part = std::sin(part), cos_part = std::cos(part);
  const double s = sin_part * cos_alpha - cos_part * sin_alpha;
  const double r = cos_part * cos_alpha + sin_part * sin_alpha;
  const double p = r - cos_alpha, q = s + sin_alpha * dot(a, b);
  const double below = (q * s + p * r) * sin_alpha;
  const double cos_b = below != 0 ? std::clamp(((q * r - p * s) * cos_alpha - q) / below, -1.0, 1.0) : 1.0;
  const Vec3d c2 = a * cos_b + toward_c * std::sqrt(1 - cos_b * cos_b);
  const double omc = u.y * (1 - std::min(1.0, dot(c2, b)));
  return b * (1 - omc) + reject(c2, b) * std::sqrt(omc * (2 - omc));
}

}  // namespace tempolux
