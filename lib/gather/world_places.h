// lib/gather/world_places.h -- places on surfaces that follow from the surfaces alone, not from a camera
// (docs/methods/records.md).
//
// Space is divided into cubic cells of the spacing s. Along each axis the cells form columns. Each column holds one
// line along the axis; a hash of the column decides where. Each crossing of a line with a surface that faces mainly
// along the axis is a place. So a surface of the area A that faces along an axis has A / s^2 places. Neighbouring
// places are at most 1.5 s apart along each of the other two axes.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <span>
#include <unordered_map>
#include <vector>

#include "lib/core/random.h"
#include "lib/trace/trace.h"

namespace tempolux {

/// Spacing [m] of the places of a class: 2^(spacing_class / 2). A class has half as many places per area as the next
/// lower one.
float spacing_of(int spacing_class);

/// A place on one side of a surface.
struct WorldPlace {
  SurfacePoint surface;
  Vec3 normal;            ///< geometric normal on this side, unit
  std::uint64_t key = 0;  ///< hash of class, column, number on the line and side; not 0
};

/// A seen point around which records are wanted.
struct WantedPlace {
  Vec3 position;  ///< scene space, m
  Vec3 normal;    ///< unit, on the wanted side
};

/// The axis directions that a surface may mainly face if its normal is within 20 degrees of `normal`, as bits: 2 axis
/// for the positive direction, 2 axis + 1 for the negative one.
std::uint8_t faced_axes(Vec3 normal);

/// The cells of a class.
class PlaceCells {
 public:
  PlaceCells(const Tracer& tracer, int spacing_class);
  /// Number of the cell along `axis` that holds a position (scene space, m).
  std::int32_t at(Vec3 position, int axis) const {
    const double cells = (origin_[axis] + double(position[axis])) / spacing_ + kShift;
    return std::int32_t(std::clamp(std::floor(cells), -1e9, 1e9));
  }
  /// Hash of the cell that holds a place.
  std::uint64_t key(Vec3 position) const {
    std::uint64_t key = 0;
    for (int axis = 0; axis < 3; ++axis) key = mix64(key ^ std::uint32_t(at(position, axis)));
    return key;
  }
  /// Scene-space coordinate [m] along `axis` of a position that is given in cells.
  float local(double cells, int axis) const { return float((cells - kShift) * spacing_ - origin_[axis]); }
  double spacing() const { return spacing_; }

 private:
  /// Cell borders are shifted by this share of the spacing off multiples of it. Surfaces often lie at whole metres and
  /// would coincide with borders.
  static constexpr double kShift = 0.381966;
  Vec3d origin_;
  double spacing_;
};

/// In each cell of this class, removes a wanted place if the places kept before it already face all its axis
/// directions. `Wanted` holds a WantedPlace `place`.
template <class Wanted>
void thin_out(const Tracer& tracer, int spacing_class, std::vector<Wanted>& wanted) {
  std::unordered_map<std::uint64_t, std::uint8_t> known;
  known.reserve(wanted.size());
  const PlaceCells cells(tracer, spacing_class);
  std::erase_if(wanted, [&](const Wanted& at) {
    const std::uint8_t faces = faced_axes(at.place.normal);
    std::uint8_t& seen = known[cells.key(at.place.position)];
    if ((seen | faces) == seen) return true;
    seen |= faces;
    return false;
  });
}

/// All places of a class that are closer than `reach` [m] to a wanted place along each axis and may face the same side
/// (less than 20 degrees apart). Also returns some places that are farther away. Ascending by column. Same places for
/// any number of threads and any order of `wanted`.
std::vector<WorldPlace> world_places(const Tracer& tracer, int spacing_class, float reach,
                                     std::span<const WantedPlace> wanted);

}  // namespace tempolux
