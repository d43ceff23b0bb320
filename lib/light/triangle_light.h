// lib/light/triangle_light.h -- one emissive triangle: points on it as seen from a point, and their density.
#pragma once

#include <vector>

#include "lib/core/vec.h"
#include "lib/scene/at_frame.h"

namespace tempolux {

/// What textures and alpha leave of the emission of a surface's material in the mean, by triangle: the same at all
/// frames at which the material's alpha is.
struct EmissionShares {
  float alpha = 1;
  std::vector<Rgb> of;  ///< mean_emission_share; empty where nothing varies: all are 1

  EmissionShares() = default;
  EmissionShares(const SceneFrame& frame, std::uint32_t surface);
};

/// An emissive triangle at a frame, scene space. The front is where the normal points.
struct TriangleLight {
  Vec3 corner{}, edge1{}, edge2{};
  Vec3 normal{};       ///< unit; zero if the triangle has no area
  float offset = 0;    ///< m: rays that leave or reach it stay this far off its plane
  double area = 0;     ///< m^2
  Rgb radiance{0.0f};  ///< W/(m^2 sr)
  bool two_sided = false;
  bool varies = false;  ///< radiance is the mean; that of a point is emitted_at's

  /// Triangle `index` of a surface, with the material's emission at the frame.
  TriangleLight(const Surface& surface, std::uint32_t index, const Material& material);
  /// A triangle of a surface of the frame. Where a texture or alpha makes its emission vary, radiance is the mean over
  /// the triangle.
  TriangleLight(const SceneFrame& frame, std::uint32_t surface, std::uint32_t index, const EmissionShares& shares);
  /// Radiance of the point of barycentrics (b1, b2), times the share of rays that meet it there.
  Rgb emitted_at(const SceneFrame& frame, std::uint32_t surface, std::uint32_t index, double b1, double b2) const {
    return varies ? varying_at(frame, surface, index, b1, b2) : radiance;
  }
  bool emits() const { return area > 0 && max_component(radiance) > 0; }
  Rgbd flux() const;                       ///< pi L A, twice that if two-sided [W]
  Vec3 point(double b1, double b2) const;  ///< by the barycentrics of corners 1 and 2

 private:
  Rgb varying_at(const SceneFrame& frame, std::uint32_t surface, std::uint32_t index, double b1, double b2) const;
};

struct TrianglePoint {
  Vec2 barycentric{};          ///< of corners 1 and 2
  Vec3 position{}, wi{};       ///< wi: unit, from the point that looks towards position
  double pdf_solid_angle = 0;  ///< [1/sr]
};

/// A point of the triangle as seen from `from`; false if it shows no emitting side there, or lies edge-on.
///
/// Where the triangle fills between 0.02 sr and all but 0.02 sr of the half sphere, in solid angle:
/// Arvo, "Stratified Sampling of Spherical Triangles", SIGGRAPH 1995; uniform, or nearly in proportion to the cosine at
/// a surface of this unit normal, if it is not zero. Elsewhere uniform in area, by Heitz' map. pdf_triangle takes the
/// same decision from the same numbers.
bool sample_triangle(const TriangleLight& light, Vec3 from, Vec3 normal, Vec2 u, TrianglePoint& sample);
/// Density per solid angle of sample_triangle at `position`; 0 where it would have returned false.
double pdf_triangle(const TriangleLight& light, Vec3 from, Vec3 normal, Vec3 position);

}  // namespace tempolux
