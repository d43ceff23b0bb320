// lib/gather/gather_directions.h -- directions of gather rays over a hemisphere, by cell and keyed by place.
#pragma once

#include <cstdint>
#include <vector>

#include "lib/core/frame.h"
#include "lib/trace/trace.h"

namespace tempolux {

/// Cells of equal weight over a hemisphere. Cell number j sectors + k holds directions of ring j, with sin^2 of the
/// angle to the normal in [j, j+1) / rings, and of sector k, with azimuths in [k, k+1) 2 pi / sectors.
struct GatherStrata {
  int rings = 0, sectors = 0;
  /// The order in which rays are followed: cells that follow each other are neighbours on the hemisphere, so that their
  /// rays visit the same parts of the scene.
  std::vector<std::uint32_t> order;

  GatherStrata() = default;
  GatherStrata(int rings, int sectors);
  /// About `rays` cells, with about pi times as many sectors as rings.
  explicit GatherStrata(int rays);
  std::size_t cells() const { return order.size(); }
};

/// The gather rays of one place. A cell has any number of rays, which are numbered and fill the cell uniformly. A ray
/// follows from key, cell and number, so it can be computed again at any time.
class GatherDirections {
 public:
  /// normal: unit, on the lit side, the axis of the hemisphere. The normals of `from` may point to either side.
  GatherDirections(const SurfacePoint& from, Vec3 normal, int rings, int sectors, std::uint64_t key);

  const Frame& frame() const { return frame_; }
  /// Computes ray number `draw` of a cell and the key of the random numbers at its hit. Returns false if the ray would
  /// start below the surface, from where no light arrives.
  bool aim(std::uint32_t cell, std::uint32_t draw, Ray& ray, std::uint64_t& ray_key) const;

 private:
  const SurfacePoint& from_;
  Frame frame_;
  Vec3 geometric_;  ///< geometric normal on the lit side
  int rings_, sectors_;
  std::uint64_t key_;
};

}  // namespace tempolux
