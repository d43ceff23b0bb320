// lib/volume/medium.h -- the participating media of a frame: extinction, albedo and scattering.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "lib/core/affine.h"
#include "lib/volume/majorants.h"
#include "lib/volume/voxel_grid.h"

namespace tempolux {

/// Optical properties of a density.
struct MediumOptions {
  float sigma_t = 1;  ///< extinction of density 1 [1/m], >= 0
  Rgb albedo{1.0f};   ///< scattered share of the extinction, each channel in [0, 1]
  float g = 0;        ///< mean cosine of scattering (Henyey-Greenstein), in (-1, 1)
};

/// One medium: a density in scene space.
class Medium {
 public:
  /// Throws std::invalid_argument unless `scene_from_index` is invertible and the options are in their ranges.
  Medium(std::shared_ptr<const VoxelGrid> grid, const Affine& scene_from_index, const MediumOptions& options);

  /// Extinction sigma_t at a point of scene space [1/m].
  float extinction(Vec3 point) const { return grid_->at(to_index(point)) * options_.sigma_t; }
  /// Upper bound [1/m] of the extinction in a box of scene space: its maximum, or more if the grid is rotated against
  /// the box.
  float largest_extinction(const Box3d& box) const;
  /// Integral [1] of the extinction over `length` m from `origin` along `direction` (unit); exact up to rounding. Along
  /// a line the trilinear density is a cubic in each voxel, which Gauss-Legendre quadrature with two points integrates
  /// exactly.
  double optical_depth(Vec3 origin, Vec3 direction, double length) const;

  const MediumOptions& options() const { return options_; }
  const VoxelGrid& grid() const { return *grid_; }
  /// Scene-space box [m] outside which the extinction is 0; empty if it is 0 everywhere.
  const Box3d& bounds() const { return bounds_; }
  /// Length of the shortest edge of a voxel [m].
  double voxel_size() const;
  /// Hash of values, transform and options.
  std::string hash() const;
  /// Position in index space of a point of scene space.
  Vec3 to_index(Vec3 point) const {
    return {dot(row_[0], point) + offset_.x, dot(row_[1], point) + offset_.y, dot(row_[2], point) + offset_.z};
  }

 private:
  std::shared_ptr<const VoxelGrid> grid_;
  Affine scene_from_index_, index_from_scene_;
  std::array<Vec3, 3> row_{};  ///< rows of index_from_scene, rounded
  Vec3 offset_;
  MediumOptions options_;
  Box3d bounds_;
};

/// All media of a frame. Where they overlap, extinctions add up. Thread-safe.
class Media {
 public:
  /// Computes majorants for these media.
  explicit Media(std::vector<Medium> media);
  /// Takes majorants that hold for all frames of a segment (frozen_majorants()). Throws std::invalid_argument if they
  /// are no upper bound of these media.
  Media(std::vector<Medium> media, MajorantGrid frozen);

  bool empty() const { return majorants_.empty(); }
  std::span<const Medium> all() const { return media_; }
  const MajorantGrid& majorants() const { return majorants_; }
  /// MajorantGrid::raise_to; must be called before other threads use this object.
  void raise_majorants_to(float least) { majorants_.raise_to(least); }
  /// Sum of the extinctions [1/m].
  float extinction(Vec3 point) const {
    float sum = 0;
    for (const Medium& medium : media_) sum += medium.extinction(point);
    return sum;
  }
  /// Chooses the medium of a collision at the point in proportion to extinction, with u in [0, 1).
  const Medium& collided(Vec3 point, float u) const;
  /// Sum of Medium::optical_depth.
  double optical_depth(Vec3 origin, Vec3 direction, double length) const;
  /// True if any phase function is anisotropic.
  bool directional() const;
  /// Hash of all media, without the majorants.
  std::string hash() const;

 private:
  std::vector<Medium> media_;
  MajorantGrid majorants_;
};

/// A grid for majorants, all 0, over the box of all media [m]. A cell's edge is eight times the edge of the finest
/// medium's voxels, `finest_voxel` [m], or more, so that there are at most kMostCells cells.
MajorantGrid majorant_cells(const Box3d& box, double finest_voxel);
/// Raises the majorant of each cell to the sum of largest_extinction() of all media, if the sum is larger.
void raise_majorants(std::span<const Medium> media, MajorantGrid& majorants);

}  // namespace tempolux
