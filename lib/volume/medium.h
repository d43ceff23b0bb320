// lib/volume/medium.h -- participating media of a frame: how much light they take out, and how it goes on.
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

/// What a density does to light.
struct MediumOptions {
  float sigma_t = 1;  ///< extinction of density 1 [1/m], >= 0
  Rgb albedo{1.0f};   ///< share of the extinction that is scattered, each channel in [0, 1]
  float g = 0;        ///< mean cosine of scattering (Henyey and Greenstein), in (-1, 1)
};

/// One medium: a density placed in scene space.
class Medium {
 public:
  /// `scene_from_index` must be invertible (std::invalid_argument).
  Medium(std::shared_ptr<const VoxelGrid> grid, const Affine& scene_from_index, const MediumOptions& options);

  /// Extinction sigma_t at a point of scene space [1/m].
  float extinction(Vec3 point) const { return grid_->at(to_index(point)) * options_.sigma_t; }
  /// Greatest extinction in a box of scene space, or more where the grid lies askew.
  float largest_extinction(const Box3d& box) const;
  /// Integral of the extinction over the way from `origin` by `length` m along the unit `direction`: exact for the
  /// trilinear density up to rounding, as a cubic along each voxel has its integral from two points (Gauss and
  /// Legendre).
  double optical_depth(Vec3 origin, Vec3 direction, double length) const;

  const MediumOptions& options() const { return options_; }
  const VoxelGrid& grid() const { return *grid_; }
  const Affine& scene_from_index() const { return scene_from_index_; }
  /// Scene-space box outside which there is nothing of it; empty if it is empty.
  const Box3d& bounds() const { return bounds_; }
  /// Length of the shortest edge of a voxel [m].
  double voxel_size() const;
  /// Content: values, place, options.
  std::string hash() const;
  Vec3 to_index(Vec3 point) const {
    return {dot(row_[0], point) + offset_.x, dot(row_[1], point) + offset_.y, dot(row_[2], point) + offset_.z};
  }

 private:
  std::shared_ptr<const VoxelGrid> grid_;
  Affine scene_from_index_, index_from_scene_;
  std::array<Vec3, 3> row_{};  ///< of index_from_scene, rounded
  Vec3 offset_;
  MediumOptions options_;
  Box3d bounds_;
};

/// All media of a frame. Where they overlap their extinctions add up. Thread-safe.
class Media {
 public:
  /// Majorants of these media alone.
  explicit Media(std::vector<Medium> media);
  /// `frozen`: majorants over a segment (frozen_majorants). Throws std::invalid_argument unless they hold for these
  /// media.
  Media(std::vector<Medium> media, MajorantGrid frozen);

  bool empty() const { return majorants_.empty(); }
  std::span<const Medium> all() const { return media_; }
  const MajorantGrid& majorants() const { return majorants_; }
  /// MajorantGrid::raise_to; before any other thread knows of this.
  void raise_majorants_to(float least) { majorants_.raise_to(least); }
  /// Sum of the extinctions [1/m].
  float extinction(Vec3 point) const {
    float sum = 0;
    for (const Medium& medium : media_) sum += medium.extinction(point);
    return sum;
  }
  /// Which medium a collision at the point is with, drawn in proportion to extinction by u in [0, 1).
  const Medium& collided(Vec3 point, float u) const;
  /// Sum of Medium::optical_depth.
  double optical_depth(Vec3 origin, Vec3 direction, double length) const;
  /// Is any phase function not the same all around?
  bool directional() const;
  /// Content of all media, not of the majorants.
  std::string hash() const;

 private:
  std::vector<Medium> media_;
  MajorantGrid majorants_;
};

/// Cells for the majorants of media: box around them all, cells of eight voxels of the finest, at most kMostCells of
/// them.
MajorantGrid majorant_cells(const Box3d& box, double finest_voxel);
/// Adds to each cell the greatest extinction that these media have in it together (sum of their maxima), if that is
/// more than it holds.
void raise_majorants(std::span<const Medium> media, MajorantGrid& majorants);

}  // namespace tempolux
