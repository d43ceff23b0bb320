// lib/light/triangle_light.h -- one emissive triangle, or a part of one: draws points on it for a shading point, and
// evaluates their pdf.
#pragma once

#include <array>

#include "lib/core/vec.h"
#include "lib/light/emission_parts.h"
#include "lib/light/light_sample.h"
#include "lib/light/light_tree.h"
#include "lib/scene/at_frame.h"

namespace tempolux {

/// A point of a triangle, drawn for a shading point.
struct TrianglePoint {
  Vec2 barycentric{};          ///< coordinates of corners 1 and 2
  Vec3 position{}, wi{};       ///< wi is unit, from the shading point towards `position`
  double pdf_solid_angle = 0;  ///< [1/sr]
};

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
  static constexpr bool distant() { return false; }
  Rgbd flux() const;  ///< W: pi L A, twice if two-sided
  /// Bounds for the light tree. `backs_within` is the box around the closed part that holds the triangle; empty if
  /// there is none (closed_parts.h).
  LightBounds bounds(const Box3& backs_within) const;
  /// Draws a point of the triangle for the point `from`, from u in [0, 1)^2. False if no emitting side faces `from`, or
  /// the triangle is seen edge-on.
  ///
  /// If the triangle's solid angle is between 0.001 sr and 2 pi - 0.001 sr, the direction is drawn by solid angle
  /// (Arvo, "Stratified Sampling of Spherical Triangles", SIGGRAPH 1995). Otherwise a point is drawn uniformly over the
  /// area, by Heitz' map. pdf_solid_angle() makes the same choice from the same numbers.
  bool sample(Vec3 from, Vec2 u, TrianglePoint& sample) const;
  /// pdf [1/sr] with which sample() draws `position` for `from`; 0 where sample() returns false.
  double pdf_solid_angle(Vec3 from, Vec3 position) const;
  /// Emits a photon whose flux is set, unless the light varies; returns the barycentric coordinates of its start. u0
  /// and u[1] give the start, u[2] chooses the side of a two-sided light. `direction` is relative to the side's normal.
  std::array<double, 2> emit(double u0, const std::array<double, 4>& u, Vec3 direction, PhotonEmission& e) const;
  Vec3 point(double b1, double b2) const;  ///< from the barycentric coordinates of corners 1 and 2
  /// Barycentric coordinates in the plane of a point that lies in the plane; (0, 0) if there is no area.
  Vec2 coordinates(Vec3 in_plane) const;

 private:
  Rgb varying_at(const SceneFrame& frame, std::uint32_t surface, std::uint32_t index, double b1, double b2) const;
};

}  // namespace tempolux
