// lib/trace/solid_around.h -- finds the absorbing solid that a place is in.
#pragma once

#include <cstdint>
#include <vector>

#include "lib/trace/trace.h"

namespace tempolux {

/// Finds in which absorbing solid (water, coloured glass) a path starts: only the sides of the boundaries that it
/// crosses tell a path where it is, and light may travel far before it meets one.
///
/// Sends 16 rays from a place, spread evenly over the sphere, or over the hemisphere of `normal`. A ray whose first hit
/// is the back of a solid's boundary says that the place is inside this solid; a front says that it is outside of all.
/// The majority decides. So a sheet of water above a basin counts as the boundary of the water below.
/// Costs nothing in scenes without absorbing solids. Thread-safe.
class SolidAround {
 public:
  /// `tracer` must outlive this object.
  explicit SolidAround(const Tracer& tracer);
  /// True if some solid of the scene absorbs light.
  bool any() const { return any_; }
  /// Material of the solid around `place`, kNone outside. The rays start `offset` m along `normal` (unit, or zero).
  std::uint32_t operator()(Vec3 place, Vec3 normal, float offset) const;

 private:
  const Tracer& tracer_;
  std::vector<char> absorbs_;  ///< by material
  bool any_ = false;
};

}  // namespace tempolux
