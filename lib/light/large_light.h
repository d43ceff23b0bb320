// lib/light/large_light.h -- a triangle or rectangle that gives much of a scene's light: its irradiance where nothing is in
// the way, and points on it stratified as seen from a point.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "lib/light/triangle_light.h"

namespace tempolux {

/// An emitter of even radiance, scene space.
struct LargeLight {
  std::array<Vec3, 4> corner{};   ///< around it
  int corners = 3;                ///< 4: a rectangle
  TriangleLight triangle;         ///< corners 0, 1, 2: all there is, or of the rectangle its half

  explicit LargeLight(const TriangleLight& t);
  bool is_rectangle() const { return corners == 4; }
};

/// Triangles that make up a rectangle are joined: two halves of one radiance, the same to a hundred thousandth of its size.
std::vector<LargeLight> join_rectangles(const std::vector<TriangleLight>& triangles);

/// The integral of max(0, normal . w) over the directions w [sr] in which the light shows an emitting side, seen from `from`:
/// its irradiance there per radiance if nothing is in the way; normal: unit. Lambert's sum over the edges of the part above
/// the horizon, right to 1e-5 of itself or to 1e-8 sr.
double projected_solid_angle(const LargeLight& light, Vec3 from, Vec3 normal);

struct LargeLightPoint {
  Vec3 position{}, wi{};       ///< wi: unit, from the point that looks towards position
  double pdf_solid_angle = 0;  ///< [1/sr]
};

inline constexpr std::size_t kLargeTogether = 8;
/// Points, samples[i] as seen from from[i], at most kLargeTogether: many cost little more than one. Bit i of the result is not
/// set if the light shows no emitting side to from[i]. Uniform in solid angle where that is large, else in
/// area: of rectangles by Urena, Fajardo and King, "An Area-Preserving Parametrization for Spherical Rectangles", EGSR 2013,
/// of triangles by sample_triangle.
unsigned sample_large_light(const LargeLight& light, std::span<const Vec3> from, std::span<const Vec2> u, LargeLightPoint* samples);
inline bool sample_large_light(const LargeLight& light, Vec3 from, Vec2 u, LargeLightPoint& sample) {
  return sample_large_light(light, {&from, 1}, {&u, 1}, &sample) != 0;
}

}  // namespace tempolux
