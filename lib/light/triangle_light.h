// lib/light/triangle_light.h -- one emissive triangle, or a part of one: draws points on it for a shading point, and
// evaluates their pdf.
#pragma once

#include "lib/core/vec.h"
#include "lib/light/emission_parts.h"
#include "lib/scene/at_frame.h"

namespace tempolux {

/// An emissive triangle, or a part of one, at a frame, scene space. The front is where the normal points.
struct TriangleLight {
  Vec3 corner{}, edge1{}, edge2{};
  Vec3 normal{};       ///< unit; zero if the triangle has no area
  float offset = 0;    ///< m; rays start or end at this distance from the triangle's plane
  double area = 0;     ///< m^2
  Rgb radiance{0.0f};  ///< W/(m^2 sr)
  bool two_sided = false;
  /// If true, `radiance` is the mean over the triangle; emitted_at() gives the radiance of a point.
  bool varies = false;
  TrianglePart part;  ///< of a triangle of the surface

  /// Triangle `index` of a surface, with the material's emission at the frame.
  TriangleLight(const Surface& surface, std::uint32_t index, const Material& material);
  /// A part of a triangle of a surface of the frame. If `varies`, radiance is the part's share of the emission.
  TriangleLight(const SceneFrame& frame, std::uint32_t surface, const EmissionPart& part, bool varies);
  /// Radiance at the barycentric coordinates (b1, b2) in this part of triangle `index`, times the share of rays that
  /// alpha lets meet the triangle there.
  Rgb emitted_at(const SceneFrame& frame, std::uint32_t surface, std::uint32_t index, double b1, double b2) const {
    return varies ? varying_at(frame, surface, index, b1, b2) : radiance;
  }
  /// True if the triangle has an area and its mean emission is not black.
  bool emits() const { return area > 0 && max_component(radiance) > 0; }
  Rgbd flux() const;                       ///< W: pi L A, twice if two-sided
  Vec3 point(double b1, double b2) const;  ///< from the barycentric coordinates of corners 1 and 2
  /// Barycentric coordinates in the plane of a point that lies in the plane; (0, 0) if there is no area.
  Vec2 coordinates(Vec3 in_plane) const;

 private:
  Rgb varying_at(const SceneFrame& frame, std::uint32_t surface, std::uint32_t index, double b1, double b2) const;
};

/// A point of a triangle, drawn for a shading point.
struct TrianglePoint {
  Vec2 barycentric{};          ///< coordinates of corners 1 and 2
  Vec3 position{}, wi{};       ///< wi is unit, from the shading point towards `position`
  double pdf_solid_angle = 0;  ///< [1/sr]
};

/// Draws a point of the triangle for the point `from`, from u in [0, 1)^2. False if no emitting side faces `from`, or
/// the triangle is seen edge-on.
///
/// If the triangle's solid angle is between 0.001 sr and 2 pi - 0.001 sr, the direction is drawn by solid angle (Arvo,
/// "Stratified Sampling of Spherical Triangles", SIGGRAPH 1995). Otherwise a point is drawn uniformly over the area, by
/// Heitz' map. pdf_triangle() makes the same choice from the same numbers.
bool sample_triangle(const TriangleLight& light, Vec3 from, Vec2 u, TrianglePoint& sample);
/// pdf [1/sr] with which sample_triangle() draws `position` for `from`; 0 where sample_triangle() returns false.
double pdf_triangle(const TriangleLight& light, Vec3 from, Vec3 position);

}  // namespace tempolux
