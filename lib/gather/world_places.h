// lib/gather/world_places.h -- places on surfaces that follow from the surfaces alone, not from a camera
// (docs/methods/records.md).
//
// Space is divided into cubic cells of the spacing s. In each column of cells along an axis a line runs at a place
// that is keyed by the column. Where the line crosses a surface that faces mainly along the axis is a place. So a
// surface of the area A that faces along an axis has A / s^2 places, at most 1.5 s apart along each other axis.
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

/// A place of a surface and one of its sides.
struct WorldPlace {
  SurfacePoint surface;
  Vec3 side;              ///< geometric normal on this side, unit
  std::uint64_t key = 0;  ///< hash of class, column, number on the line and side; not 0
};

/// A place around which others are wanted.
struct WantedPlace {
  Vec3 position;  ///< scene space, m
  Vec3 normal;    ///< unit, on the wanted side
};

/// Bits of the directions along axes that places near a place with this normal may face: bit 2 axis for the positive
/// direction, bit 2 axis + 1 for the negative one.
std::uint8_t faced_axes(Vec3 normal);

/// The cells of a class.
class PlaceCells {
 public:
  PlaceCells(const Tracer& tracer, int spacing_class);
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
  /// Scene coordinate [m] of a place in cells.
  float local(double cells, int axis) const { return float((cells - kShift) * spacing_ - origin_[axis]); }
  double spacing() const { return spacing_; }

 private:
  /// Borders of cells lie at these shares of the spacing, because surfaces of scenes often lie at whole numbers.
  static constexpr double kShift = 0.381966;
  Vec3d origin_;
  double spacing_;
};

/// Keeps one of the wanted places in each cell of this class that face the same of the six axes, the first one.
/// `Wanted` holds a WantedPlace `place`.
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
