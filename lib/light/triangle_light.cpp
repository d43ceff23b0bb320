#include "lib/light/triangle_light.h"

#include <algorithm>
#include <cmath>

#include "lib/core/frame.h"
#include "lib/core/pi.h"
#include "lib/core/sampling.h"
#include "lib/light/spherical_triangle.h"
#include "lib/scene/texture_lookup.h"

namespace tempolux {
namespace {

constexpr float kOffsetScale = 0x1p-20f;  // offset / largest coordinate; equals kOffsetScale of lib/trace/trees.h

/// The triangle as seen from a point.
struct View {
  Vec3 v0, v1, v2;           // vectors to the corners, m
  float l0, l1, l2;          // their lengths
  float height;              // m, of the point above the triangle's plane; positive on an emitting side
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
  /// True if the triangle is large enough to be sampled by solid angle and the point is not so close to its plane that
  /// directions degenerate.
  bool large() const {
    // tan(omega / 2) of the least solid angle omega, 0.001 sr. A right triangle of this size at the distance d has legs
    // of sqrt(.002) d = .045 d. The weight of points drawn by area, area x height / d^3, varies by 13 % over it, which
    // adds 4 % of standard deviation to a sample. Arvo's method would take more time than that saves.
    constexpr float kTangent = 0.0005f;
    return adjacent > 0 ? opposite > kTangent * adjacent : opposite > -kTangent * adjacent;
  }
  /// Van Oosterom & Strackee, "The Solid Angle of a Plane Triangle", IEEE Trans. Biomed. Eng. 30(2), 1983.
  float solid_angle() const { return 2 * std::atan2(opposite, adjacent); }
};

/// Barycentric coordinates (b1, b2) where the ray along w meets the triangle's plane, clamped to the triangle.
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
  const Vec3 p0 = surface.position(corners[0]), p1 = surface.position(corners[1]), p2 = surface.position(corners[2]);
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

TriangleLight::TriangleLight(const SceneFrame& frame, std::uint32_t surface, const EmissionPart& of, bool it_varies)
    : TriangleLight(frame.surfaces[surface], of.triangle, frame.materials[frame.surfaces[surface].material]) {
  varies = it_varies;
  part = of.where;
  if (varies) radiance = radiance * of.share;
  if (part.size == 1) return;
  corner = point(part.corner.x, part.corner.y);
  edge1 = edge1 * part.size;
  edge2 = edge2 * part.size;
  area *= double(part.size) * double(part.size);
}

Rgb TriangleLight::varying_at(const SceneFrame& frame, std::uint32_t surface, std::uint32_t index, double b1,
                              double b2) const {
  const Vec2 b = part.at(b1, b2);
  return emission_at(frame, surface, index, b.x, b.y, 0) * coverage_at(frame, surface, index, b.x, b.y);
}

Rgbd TriangleLight::flux() const { return Rgbd(radiance) * (kPiD * area * (two_sided ? 2 : 1)); }

Vec3 TriangleLight::point(double b1, double b2) const {
  return Vec3(Vec3d(corner) + Vec3d(edge1) * b1 + Vec3d(edge2) * b2);
}

Vec2 TriangleLight::coordinates(Vec3 in_plane) const {
  const Vec3d e1(edge1), e2(edge2), to = Vec3d(in_plane) - Vec3d(corner), n = cross(e1, e2);
  const double square = dot(n, n);
  if (!(square > 0)) return {0, 0};
  return {float(dot(cross(to, e2), n) / square), float(dot(cross(e1, to), n) / square)};
}

LightBounds TriangleLight::bounds(const Box3& backs_within) const {
  LightBounds b;
  b.box.add(corner);
  b.box.add(corner + edge1);
  b.box.add(corner + edge2);
  b.axis = normal;
  b.add_weight(normal, double(max_component(radiance)) * area);
  b.two_sided = two_sided && backs_within.empty();
  if (two_sided) b.backs_within = backs_within;
  return b;
}

bool TriangleLight::sample(Vec3 from, Vec2 u, TrianglePoint& sample) const {
  const View view(*this, from);
  if (!view.visible) return false;
  const bool large = view.large();
  Vec2 b;
  double density = 1;
  if (large) {
    const double omega = view.solid_angle();
    density = 1 / omega;
    b = project(*this, view, sample_spherical_triangle(as_seen(view.v0, view.v1, view.v2), omega, u));
  } else {
    b = tempolux::sample_triangle(u);
  }
  const Vec3 shift = edge1 * b.x + edge2 * b.y, to = view.v0 + shift;
  sample.barycentric = b;
  sample.position = corner + shift;
  const float distance = length(to);
  if (!(distance > 0)) return false;
  sample.wi = to / distance;
  const double d = distance;
  sample.pdf_solid_angle = large ? density : density * d * d * d / (area * view.height);
  return sample.pdf_solid_angle < INFINITY;
}

double TriangleLight::pdf_solid_angle(Vec3 from, Vec3 position) const {
  const View view(*this, from);
  if (!view.visible) return 0;
  if (view.large()) return 1 / view.solid_angle();
  const double d = length(Vec3d(position) - Vec3d(from));
  const double pdf = d * d * d / (area * view.height);
  return pdf < INFINITY ? pdf : 0;
}

std::array<double, 2> TriangleLight::emit(double u0, const std::array<double, 4>& u, Vec3 direction,
                                          PhotonEmission& e) const {
  // Heitz' map from the square to the triangle, as in sample(), in double precision.
  const double half = 0.5 * std::min(u0, u[1]), b1 = u0 - half, b2 = u[1] - half;
  const double side = two_sided ? 1 - 2 * std::floor(2 * u[2]) : 1;
  e.origin = point(b1, b2);
  e.normal = normal * float(side);
  e.origin_offset = offset;
  e.travel = area > 0 ? Frame(e.normal).to_world(direction) : Vec3{0, 0, 1};
  return {b1, b2};
}

}  // namespace tempolux
