// tests/support/media.h -- media made by hand.
#pragma once

#include <cmath>
#include <memory>
#include <vector>

#include "lib/volume/medium.h"

namespace tempolux::test {

/// A cube of density 1: 16^3 voxels, `edge` m long, around `centre`. At its borders the density falls to 0 over one
/// voxel.
inline std::shared_ptr<const Media> cube_of_medium(Vec3d centre, double edge, const MediumOptions& options) {
  std::vector<VoxelBlock> blocks;
  for (int b = 0; b < 8; ++b) {
    VoxelBlock block{{b & 1 ? 8 : 0, b & 2 ? 8 : 0, b & 4 ? 8 : 0}, {}};
    block.values.fill(1);
    blocks.push_back(block);
  }
  Affine place;
  const double voxel = edge / 16;
  place.row = {Vec3d{voxel, 0, 0}, Vec3d{0, voxel, 0}, Vec3d{0, 0, voxel}};
  place.translation = centre - Vec3d{7.5, 7.5, 7.5} * voxel;
  std::vector<Medium> media;
  media.emplace_back(std::make_shared<const VoxelGrid>(blocks), place, options);
  return std::make_shared<const Media>(std::move(media));
}

}  // namespace tempolux::test
