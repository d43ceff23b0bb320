// lib/gather/gather_directions.h -- where the rays of a place's hemisphere go: cells by number, keyed.
#pragma once

#include <cstdint>
#include <vector>

#include "lib/core/frame.h"
#include "lib/trace/trace.h"

namespace tempolux {

/// Cells of equal weight over a hemisphere, number j sectors + k: ring j holds sin^2 of the angle from the normal in
/// [j, j+1) / rings, sector k azimuths in [k, k+1) 2 pi / sectors.
struct GatherStrata {
  int rings = 0, sectors = 0;
  /// An order in which to follow the cells: neighbours in it are neighbours on the hemisphere, so that rays share what
  /// they visit.
  std::vector<std::uint32_t> order;

  GatherStrata() = default;
  GatherStrata(int rings, int sectors);
  /// About `rays` cells, sectors about pi times rings.
  explicit GatherStrata(int rays);
  std::size_t cells() const { return order.size(); }
};

/// A key for the rays of a place, from where it is, to the bit: the record of a place does not depend on others.
std::uint64_t gather_key(Vec3 position, Vec3 normal, std::uint64_t seed);

/// The rays of one place. Each cell has as many as are asked for, numbered: all spread over the cell alike, and any of
/// them can be aimed again later from key, cell and number alone.
class GatherDirections {
 public:
  /// normal: unit, on the lit side; cells lie about it. `from` may be seen from either side.
  GatherDirections(const SurfacePoint& from, Vec3 normal, int rings, int sectors, std::uint64_t key);

  const Frame& frame() const { return frame_; }
  /// The draw-th ray of a cell, and a key for the random numbers of what it meets. False if the ray would start below
  /// the surface: nothing arrives from there.
  bool aim(std::uint32_t cell, std::uint32_t draw, Ray& ray, std::uint64_t& ray_key) const;

 private:
  const SurfacePoint& from_;
  Frame frame_;
  Vec3 geometric_;  ///< normal on the lit side
  int rings_, sectors_;
  std::uint64_t key_;
};

}  // namespace tempolux
