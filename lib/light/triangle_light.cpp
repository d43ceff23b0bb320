#include "lib/light/triangle_light.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "lib/core/parallel.h"
#include "lib/core/sampling.h"
#include "lib/scene/texture_lookup.h"

namespace tempolux {
namespace {

constexpr double kPiD = std::numbers::pi;
constexpr float kOffsetScale = 0x1p-20f;  // of the largest coordinate, as for rays that leave surfaces

/// The triangle as seen from a point.
struct View {
  Vec3 v0, v1, v2;           // to the corners
  float l0, l1, l2;          // their lengths
  float height;              // of the point above the plane, positive on an emitting side
  float opposite, adjacent;  // tan(solid angle / 2) = opposite / adjacent
  bool visible;

  View(const TriangleLight& t, Vec3 from) : v0(t.corner - from), v1(v0 + t.edge1), v2(v0 + t.edge2) {
    height = -dot(t.normal, v0);
    if (t.two_sided) height = std::abs(height);
    l0 = length(v0);
    l1 = length(v1);
    l2 = length(v2);
    opposite = height * float(2 * t.area);
    adjacent = l0 * l1 * l2 + dot(v0, v1) * l2 + dot(v1, v2) * l0 + dot(v2, v0) * l1;
    visible = height > 0 && t.area > 0;
  }
  /// Large enough to sample by solid angle, and not so close that the directions degenerate.
  bool large() const {
    constexpr float kTangent = 0.01f;  // of half the solid angle's bound
    return adjacent > 0 ? opposite > kTangent * adjacent : opposite > -kTangent * adjacent;
  }
  float solid_angle() const { return 2 * std::atan2(opposite, adjacent); }
};

Vec3d unit(Vec3d v) { return v * (1 / std::sqrt(std::max(1e-300, length2(v)))); }
/// Unit vector along v less its part along the unit vector w.
Vec3d reject(Vec3d v, Vec3d w) { return unit(v - w * dot(v, w)); }

/// Direction uniform in the spherical triangle abc of the given solid angle [Arvo 1995]. In double: thin
/// triangles cancel most digits.
Vec3d sample_spherical_triangle(Vec3d a, Vec3d b, Vec3d c, double area, Vec2 u) {
  const Vec3d toward_b = reject(b, a), toward_c = reject(c, a);
  const double cos_alpha = std::clamp(dot(toward_b, toward_c), -1.0, 1.0);
  const double sin_alpha = length(cross(toward_b, toward_c));
  // phi = part of the area - alpha; sine and cosine of the difference
  const double part = u.x * area, sin_part = std::sin(part), cos_part = std::cos(part);
  const double s = sin_part * cos_alpha - cos_part * sin_alpha;
  const double t = cos_part * cos_alpha + sin_part * sin_alpha;
  const double p = t - cos_alpha, q = s + sin_alpha * dot(a, b);
  const double below = (q * s + p * t) * sin_alpha;
  const double cos_b = below != 0 ? std::clamp(((q * t - p * s) * cos_alpha - q) / below, -1.0, 1.0) : 1.0;
  const Vec3d c2 = a * cos_b + toward_c * std::sqrt(1 - cos_b * cos_b);
  const double omc = u.y * (1 - std::min(1.0, dot(c2, b)));
  return b * (1 - omc) + reject(c2, b) * std::sqrt(omc * (2 - omc));
}

/// Barycentrics (b1, b2) where the ray from the view's point along w meets the triangle, held inside.
Vec2 project(const TriangleLight& t, const View& view, Vec3d w) {
  const Vec3d edge1(t.edge1), edge2(t.edge2), s1 = cross(w, edge2), s = -Vec3d(view.v0);
  const double divisor = dot(s1, edge1);
  if (divisor == 0) return {1.0f / 3, 1.0f / 3};
  double b1 = std::clamp(dot(s, s1) / divisor, 0.0, 1.0);
  double b2 = std::clamp(dot(w, cross(s, edge1)) / divisor, 0.0, 1.0);
  if (const double sum = b1 + b2; sum > 1) b1 /= sum, b2 /= sum;
  return {float(b1), float(b2)};
}

}  // namespace

TriangleLight::TriangleLight(const Surface& surface, std::uint32_t index, const Material& material) {
  const auto& corners = surface.primitive->triangles[index];
  const Vec3 p0 = surface.position(corners[0]), p1 = surface.position(corners[1]),
             p2 = surface.position(corners[2]);
  corner = p0;
  edge1 = p1 - p0;
  edge2 = p2 - p0;
  const Vec3d n = cross(Vec3d(p1) - Vec3d(p0), Vec3d(p2) - Vec3d(p0));
  area = 0.5 * length(n);
  normal = Vec3(normalize(surface.flipped ? -n : n));
  if (!(length2(normal) > 0)) area = 0;
  offset = kOffsetScale * max_component(max(max(abs(p0), abs(p1)), abs(p2)));
  radiance = material.emission;
  two_sided = material.double_sided;
}

EmissionShares::EmissionShares(const SceneFrame& frame, std::uint32_t surface)
    : alpha(frame.materials[frame.surfaces[surface].material].alpha) {
  if (!emission_varies(frame.materials[frame.surfaces[surface].material])) return;
  of.resize(frame.surfaces[surface].primitive->triangles.size());
  parallel_chunks(of.size(), 1024, [&](std::size_t first, std::size_t last) {
    for (std::size_t t = first; t < last; ++t) of[t] = mean_emission_share(frame, surface, std::uint32_t(t));
  });
}

TriangleLight::TriangleLight(const SceneFrame& frame, std::uint32_t surface, std::uint32_t index,
                             const EmissionShares& shares)
    : TriangleLight(frame.surfaces[surface], index, frame.materials[frame.surfaces[surface].material]) {
  varies = !shares.of.empty();
  if (varies) radiance = radiance * shares.of[index];
}

Rgb TriangleLight::varying_at(const SceneFrame& frame, std::uint32_t surface, std::uint32_t index, double b1,
                              double b2) const {
  return emission_at(frame, surface, index, float(b1), float(b2), 0) *
         coverage_at(frame, surface, index, float(b1), float(b2));
}

Rgbd TriangleLight::flux() const { return Rgbd(radiance) * (kPiD * area * (two_sided ? 2 : 1)); }

Vec3 TriangleLight::point(double b1, double b2) const {
  return Vec3(Vec3d(corner) + Vec3d(edge1) * b1 + Vec3d(edge2) * b2);
}

bool sample_triangle(const TriangleLight& light, Vec3 from, Vec2 u, TrianglePoint& sample) {
  const View view(light, from);
  if (!view.visible) return false;
  const bool large = view.large();
  Vec2 b;
  float omega = 0;
  if (large) {
    omega = view.solid_angle();
    b = project(light, view,
                sample_spherical_triangle(unit(Vec3d(view.v0)), unit(Vec3d(view.v1)), unit(Vec3d(view.v2)),
                                          omega, u));
  } else {
    b = sample_triangle(u);
  }
  const Vec3 offset = light.edge1 * b.x + light.edge2 * b.y, to = view.v0 + offset;
  sample.barycentric = b;
  sample.position = light.corner + offset;
  const float distance = length(to);
  if (!(distance > 0)) return false;
  sample.wi = to / distance;
  const double d = distance;
  sample.pdf_solid_angle = large ? 1.0 / omega : d * d * d / (light.area * view.height);
  return sample.pdf_solid_angle < INFINITY;
}

double pdf_triangle(const TriangleLight& light, Vec3 from, Vec3 position) {
  const View view(light, from);
  if (!view.visible) return 0;
  if (view.large()) return 1.0 / view.solid_angle();
  const double d = length(position - from);
  const double pdf = d * d * d / (light.area * view.height);
  return pdf < INFINITY ? pdf : 0;
}

double solid_angle(const TriangleLight& light, Vec3 from) {
  const View view(light, from);
  return view.visible ? view.solid_angle() : 0;
}

}  // namespace tempolux
