// lib/gather/mesh_elements.h -- light textures: photons counted by small triangles of the surfaces, and smoothed along them.
//
// Paper: Jimenez, Myszkowski, Pueyo 2005, sections 3 and 6. Method: docs/methods/light_textures.md.
#pragma once

#include <cstdint>
#include <map>
#include <span>
#include <tuple>
#include <vector>

#include "formats/meshirrad/meshirrad.h"
#include "formats/photons/photons.h"
#include "lib/trace/trace.h"

namespace tempolux {

struct MeshFilter {
  enum class Kind : std::uint8_t { none, box, gaussian, bilateral };
  Kind kind = Kind::gaussian;
  double width = 0;         ///< m: half the box's edge, or the Gaussian's standard deviation; 0: so wide that about 256 photons count
  float range = 0.5f;       ///< bilateral: standard deviation of ln irradiance over which elements count as alike
};

struct MeshOptions {
  double cell = 0;          ///< m, longest edge of an element; 0: the filter's width
  MeshFilter filter;
};

/// What photons bring to the elements that they arrive at, as whole multiples of a unit: adding a photon and taking it away again leaves
/// what was there. An element is found by a short ray onto the surface from the side at which the photon arrived.
class MeshSums {
 public:
  struct Cell {
    std::uint32_t photons = 0;
    std::array<std::int64_t, 3> sums{};
    bool operator==(const Cell&) const = default;
  };
  using Side = std::tuple<std::uint32_t, std::uint32_t, std::uint16_t>;   ///< surface, triangle, side

  /// `cell` [m] > 0; `unit` [W] > 0.
  MeshSums(const Tracer& tracer, double cell, double unit) : tracer_(tracer), cell_(cell), unit_(unit) {}
  /// Adds (times = 1) or takes away (-1) photons at surfaces; positions plus `offset` are scene space. The same for any number of threads.
  void add(std::span<const formats::Photon> photons, Vec3 offset, int times = 1);
  /// Of the sides that photons arrived at: their cells.
  const std::map<Side, std::vector<Cell>>& cells() const { return cells_; }
  /// Photons that no surface was found for: it has moved, or is thinner than a thousandth of a cell.
  std::uint64_t lost() const { return lost_; }
  double cell() const { return cell_; }
  double unit() const { return unit_; }

 private:
  const Tracer& tracer_;
  double cell_, unit_;
  std::map<Side, std::vector<Cell>> cells_;
  std::uint64_t lost_ = 0;
};

/// Cuts of each edge of a triangle so that no piece is longer than `cell` [m]; at most formats::kMostCuts.
std::uint32_t mesh_cuts(const SceneFrame& frame, std::uint32_t surface, std::uint32_t triangle, double cell);

/// Area of all surfaces of the frame, one side [m^2].
double surface_area(const SceneFrame& frame);

/// Widths that are 0 filled in, for so many photons: a Gaussian of deviation s counts as much area as 4 pi s^2.
MeshOptions with_widths(const MeshOptions& options, const SceneFrame& frame, std::uint64_t photons);

/// Most elements of a frame, lit or not: 2^25, 2 GB.
inline constexpr std::uint64_t kMostElements = std::uint64_t(1) << 25;

/// All elements that light reaches through the filter, in the order of the file. Irradiance [W/m^2]: flux over area, both weighted by the
/// same kernel around the element, over elements that face the same way (normals within 30 degrees) and lie in its plane within a
/// width: nothing is lost at edges, and light does not go around corners. The bilateral one then weighs by how alike irradiance is, as
/// the Gaussian of the same width has it, and the whole flux of each object is put right. InputError beyond kMostElements.
/// `origin`: the frame's.
std::vector<formats::MeshElement> light_texture(const SceneFrame& frame, const MeshSums& sums, const MeshFilter& filter);

}  // namespace tempolux
