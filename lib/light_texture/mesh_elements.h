// lib/light_texture/mesh_elements.h -- light textures: counts photons by small triangles of the surfaces, and smooths
// the counts along the surfaces.
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
  enum class Kind : std::uint8_t { none, box, gaussian };
  Kind kind = Kind::gaussian;
  /// m: half the box's edge, or the Gaussian's standard deviation; 0: chosen so that about 256 photons count.
  double width = 0;
};

struct MeshOptions {
  double cell = 0;  ///< m, longest edge of an element; 0: the width of the filter
  MeshFilter filter;
};

/// Divides the triangles of a frame into elements: each edge of a triangle is cut into n equal parts, with the smallest
/// n for which no part is longer than `cell` [m], but at most formats::kMostCuts. Triangles of movers are measured in
/// all given frames, so that they have the same elements in all frames of a segment.
class MeshCuts {
 public:
  /// `measured`: at least one frame, all of one segment; they must outlive this object.
  MeshCuts(double cell, std::vector<const SceneFrame*> measured) : cell_(cell), measured_(std::move(measured)) {}
  /// n of a triangle.
  std::uint32_t operator()(std::uint32_t surface, std::uint32_t triangle) const;
  double cell() const { return cell_; }

 private:
  double cell_;
  std::vector<const SceneFrame*> measured_;
};

/// Sums the flux of photons over the elements at which they arrive, as integer multiples of a unit, so that the sums do
/// not depend on the order. The element of a photon is found with a short ray to the surface, from the side at which
/// the photon arrived.
class MeshSums {
 public:
  struct Cell {
    std::uint32_t photons = 0;
    std::array<std::int64_t, 3> sums{};
    double squares = 0;  ///< sum of the squared luminance of the photons' flux, unit^2
    bool operator==(const Cell&) const = default;
  };
  using Side = std::tuple<std::uint32_t, std::uint32_t, std::uint16_t>;  ///< surface, triangle, side

  /// `unit` [W]: > 0.
  MeshSums(const Tracer& tracer, const MeshCuts& cuts, double unit) : tracer_(tracer), cuts_(cuts), unit_(unit) {}
  /// Adds photons at surfaces. `offset` [m] brings their positions into scene space. Same result for any number of
  /// threads.
  void add(std::span<const formats::Photon> photons, Vec3 offset);
  /// The cells of all sides at which photons arrived.
  const std::map<Side, std::vector<Cell>>& cells() const { return cells_; }
  /// Number of photons without an element: their surface has moved, or it is thinner than a thousandth of a cell.
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

/// Mean number of photons under the spatial filter: the relative noise is 1/16.
inline constexpr double kPhotonsInKernel = 256;
/// Standard deviation [m] of the Gaussian that averages `in_kernel` photons, if `photons` are spread over `area` [m^2];
/// 1 without surfaces. The Gaussian averages over an area of 4 pi deviations squared.
double kernel_width(double area, double photons, double in_kernel = kPhotonsInKernel);

/// Edge length of the elements of windows, in standard deviations of the filter. Light is interpolated linearly between
/// elements, so smaller elements would not show more.
inline constexpr double kCellOfWindows = 2;

/// Area of one side of all surfaces of the frame together [m^2].
double surface_area(const SceneFrame& frame);

/// The options with a filter width of 0 replaced by kernel_width(area, photons), and an element edge of 0 replaced by
/// `cell` times the filter width.
MeshOptions with_widths(const MeshOptions& options, double area, double photons, double cell = 1);

/// Largest number of elements of a frame, lit or not. They take 2 GB.
inline constexpr std::uint64_t kMostElements = std::uint64_t(1) << 25;

/// All elements of a frame in the order of the file, for both sides of each triangle with an area, without light.
/// Throws InputError above kMostElements.
std::vector<formats::MeshElement> all_elements(const SceneFrame& frame, const MeshCuts& cuts);
/// Stores the photons' sums in the elements.
void put_sums(const MeshSums& sums, std::vector<formats::MeshElement>& elements);
/// Removes the sides of triangles that have neither light nor photons.
void leave_out_dark(std::vector<formats::MeshElement>& elements);

/// Computes the irradiance [W/m^2] of all_elements() from their `flux` [W]: the sum of flux over the sum of area,
/// both weighted by the same kernel around the element. Another element counts only if
///   - its normal is within 45 degrees of the element's normal (Clearance::kBend),
///   - it lies within a width of the element's plane,
///   - it has the same material,
///   - both lie outside of solids, or both inside. An element lies inside if the first surface above it shows its back.
/// So no light is lost at edges, no light spreads around corners, and the dark inside of a double wall takes no light.
/// Each object keeps its total flux. `widths` [m]: the filter's width at each element, 0 if no light arrives there;
/// empty: filter.width everywhere.
void smooth_elements(const Tracer& tracer, std::span<const Rgbd> flux, const MeshFilter& filter,
                     std::span<const float> widths, std::vector<formats::MeshElement>& elements);

/// Flux of all elements.
struct MeshFlux {
  std::vector<Rgbd> mean;       ///< W
  std::vector<double> squares;  ///< W^2: variance of its luminance
};

/// Computes the irradiance [W/m^2] of all_elements() as smooth_elements() does, but smooths only as much as the noise
/// requires. Gaussians with the deviations `width`, 2 `width` and 4 `width` [m] (or 1, 2 and 4 times `widths`) divide
/// light into a smooth part and two finer bands. Each place keeps the share signal / (signal + noise) of each band
/// [Wiener]. Here signal + noise is the mean square of the band around the place, and noise follows from
/// `flux.squares`. Each object keeps its total flux.
void smooth_by_scales(const Tracer& tracer, const MeshFlux& flux, double width, std::span<const float> widths,
                      std::vector<formats::MeshElement>& elements);

}  // namespace tempolux
