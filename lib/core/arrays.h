// lib/core/arrays.h -- vectors and colours from the arrays of files, and back.
#pragma once

#include <array>

#include "lib/core/vec.h"

namespace tempolux {

inline std::array<float, 3> array_of(Vec3 v) { return {v.x, v.y, v.z}; }
inline std::array<double, 3> array_of(Vec3d v) { return {v.x, v.y, v.z}; }
inline std::array<float, 3> array_of(const Rgb& c) { return {c.r, c.g, c.b}; }
inline std::array<double, 3> array_of(const Rgbd& c) { return {c.r, c.g, c.b}; }
inline Vec3 vec_of(const std::array<float, 3>& a) { return {a[0], a[1], a[2]}; }
inline Vec3d vec_of(const std::array<double, 3>& a) { return {a[0], a[1], a[2]}; }
inline Rgb rgb_of(const std::array<float, 3>& a) { return {a[0], a[1], a[2]}; }

/// A position of a file, plus `shift` (the origin of the file's space, seen from the wanted space). Rounds once.
inline Vec3 shifted(const std::array<float, 3>& place, Vec3d shift) { return Vec3(Vec3d(vec_of(place)) + shift); }

}  // namespace tempolux
