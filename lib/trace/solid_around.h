// lib/trace/solid_around.h -- finds the absorbing solid that a place is in.
#pragma once

#include <cstdint>
#include <vector>

#include "lib/trace/trace.h"

namespace tempolux {

/// Finds the absorbing solid (water, coloured glass) in which a path starts. Later the path knows the solid from the
/// sides of the boundaries that it crosses, but light may travel far before it crosses one.
///
/// Sends 16 uniform rays from a place into the sphere, or into the hemisphere of `normal`. A ray whose first hit is the
/// back of a solid's boundary is a vote for this solid, a front is a vote for none. A solid needs more votes than none
/// has, and a quarter of the rays. So a sheet of water above a basin is the boundary of the water below, and a window
/// of coloured glass that is modelled as one sheet does not make its room a solid.
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
