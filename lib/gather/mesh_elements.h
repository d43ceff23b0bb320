// lib/gather/mesh_elements.h -- light textures: photons counted by small triangles of the surfaces, and smoothed along
// them.
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

/// Cosine of 30 degrees: elements whose normals differ by more than that do not share their light.
inline constexpr float kSameWay = 0.866f;

struct MeshFilter {
  enum class Kind : std::uint8_t { none, box, gaussian, bilateral };
  Kind kind = Kind::gaussian;
  double width =
      0;  ///< m: half the box's edge, or the Gaussian's standard deviation; 0: so wide that about 256 photons count
  float range = 0.5f;  ///< bilateral: standard deviation of ln irradiance over which elements count as alike
};

struct MeshOptions {
  double cell = 0;  ///< m, longest edge of an element; 0: the filter's width
  MeshFilter filter;
};

/// How the triangles of a frame are cut into elements: each edge into so many pieces that none is longer than `cell`
/// [m], at most formats::kMostCuts. What moves is measured in several frames, so that it has the same elements in all
/// frames of a segment.
class MeshCuts {
 public:
  /// `measured`: frames of one segment, which must outlive this; at least one.
  MeshCuts(double cell, std::vector<const SceneFrame*> measured) : cell_(cell), measured_(std::move(measured)) {}
  std::uint32_t operator()(std::uint32_t surface, std::uint32_t triangle) const;
  double cell() const { return cell_; }

 private:
  double cell_;
  std::vector<const SceneFrame*> measured_;
};

/// What photons bring to the elements that they arrive at, as whole multiples of a unit: the sums have no order. An
/// element is found by a short ray onto the surface from the side at which the photon arrived.
class MeshSums {
 public:
  struct Cell {
    std::uint32_t photons = 0;
    std::array<std::int64_t, 3> sums{};
    double squares = 0;  ///< of the photons' luminance, unit^2
    bool operator==(const Cell&) const = default;
  };
  using Side = std::tuple<std::uint32_t, std::uint32_t, std::uint16_t>;  ///< surface, triangle, side

  /// `unit` [W] > 0.
  MeshSums(const Tracer& tracer, const MeshCuts& cuts, double unit) : tracer_(tracer), cuts_(cuts), unit_(unit) {}
  /// Adds photons at surfaces; positions plus `offset` are scene space. The same for any number of threads.
  void add(std::span<const formats::Photon> photons, Vec3 offset);
  /// Of the sides that photons arrived at: their cells.
  const std::map<Side, std::vector<Cell>>& cells() const { return cells_; }
  /// Photons that no surface was found for: it has moved, or is thinner than a thousandth of a cell.
  std::uint64_t lost() const { return lost_; }
  const MeshCuts& cuts() const { return cuts_; }
  double unit() const { return unit_; }

 private:
  const Tracer& tracer_;
  MeshCuts cuts_;
  double unit_;
  std::map<Side, std::vector<Cell>> cells_;
  std::uint64_t lost_ = 0;
};

/// Photons that the spatial filter counts in the mean of an element: noise of 1/16.
inline constexpr double kPhotonsInKernel = 256;
/// Deviation [m] of the Gaussian that counts `in_kernel` of the photons that are spread over an area [m^2]: it counts
/// as much area as 4 pi deviations squared.
double kernel_width(double area, double photons, double in_kernel = kPhotonsInKernel);

/// Light textures of windows, the photons of many frames. Photons that the filter counts in the mean of a full one:
/// noise of 1/50.
inline constexpr double kPhotonsInWindow = 2500;
/// Edge of their elements, in deviations of the filter: light is read linearly between elements, so that smaller ones
/// would show no more.
inline constexpr double kCellOfWindows = 2;
/// Their widths where so many photons arrive in all frames of a full window at surfaces of this area.
MeshOptions window_widths(double area, double photons);

/// Area of all surfaces of the frame, one side [m^2].
double surface_area(const SceneFrame& frame);

/// Widths that are 0 filled in, for so many photons: a Gaussian of deviation s counts as much area as 4 pi s^2.
MeshOptions with_widths(const MeshOptions& options, const SceneFrame& frame, std::uint64_t photons);

/// Most elements of a frame, lit or not: 2^25, 2 GB.
inline constexpr std::uint64_t kMostElements = std::uint64_t(1) << 25;

/// All elements of a frame in the order of the file, both sides of each triangle that has an area, with no light in
/// them. InputError beyond kMostElements.
std::vector<formats::MeshElement> all_elements(const SceneFrame& frame, const MeshCuts& cuts);
/// Puts the photons in.
void put_sums(const MeshSums& sums, std::vector<formats::MeshElement>& elements);
/// Leaves out the sides of triangles that neither light nor photons reach.
void leave_out_dark(std::vector<formats::MeshElement>& elements);

/// Sets the irradiance [W/m^2] of all_elements() from their `flux` [W]: flux over area, both weighted by the
/// same kernel around the element, over elements that face the same way (normals within 30 degrees), lie in its plane
/// within a width, and have its material: nothing is lost at edges, and light does not go around corners. The bilateral
/// filter then weighs by how alike irradiance is, as the Gaussian of the same width has it. The whole flux of each
/// object is kept. `widths` [m]: each element's own, in place of the filter's; 0: nothing arrives there. Empty: the
/// filter's.
void smooth_elements(const SceneFrame& frame, std::span<const Rgbd> flux, const MeshFilter& filter,
                     std::span<const float> widths, std::vector<formats::MeshElement>& elements);

/// The elements that light reaches through the filter, in the order of the file.
std::vector<formats::MeshElement> light_texture(const SceneFrame& frame, const MeshSums& sums,
                                                const MeshFilter& filter);

}  // namespace tempolux
