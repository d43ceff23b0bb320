#include "lib/volume/medium.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "formats/hash.h"
#include "lib/core/box_corners.h"
#include "lib/core/parallel.h"

namespace tempolux {
namespace {

Box3d transformed(const Affine& to_from, const Box3d& box) {
  Box3d result;
  add_corners(result, box, to_from);
  return result;
}

/// The box in float32, rounded outward.
Box3 outwards(const Box3d& box) {
  Box3 result;
  for (int a = 0; a < 3; ++a) {
    result.lower[a] = std::nextafter(float(box.lower[a]), -INFINITY);
    result.upper[a] = std::nextafter(float(box.upper[a]), INFINITY);
  }
  return result;
}

/// The interval of t for which origin + t direction, 0 <= t <= length, is inside the box; false if there is none.
bool clip(const Box3d& box, Vec3d origin, Vec3d direction, double length, double& begin, double& end) {
  begin = 0;
  end = length;
  for (int a = 0; a < 3; ++a) {
    if (direction[a] == 0) {
      if (origin[a] < box.lower[a] || origin[a] > box.upper[a]) return false;
      continue;
    }
    double near = (box.lower[a] - origin[a]) / direction[a], far = (box.upper[a] - origin[a]) / direction[a];
    if (near > far) std::swap(near, far);
    begin = std::max(begin, near);
    end = std::min(end, far);
  }
  return begin < end;
}

Box3d joint_bounds(std::span<const Medium> media) {
  Box3d box;
  for (const Medium& medium : media) box.add(medium.bounds());
  return box;
}

MajorantGrid own_majorants(std::span<const Medium> media) {
  const Box3d box = joint_bounds(media);
  if (box.empty()) return {};
  double finest = INFINITY;
  for (const Medium& medium : media)
    if (!medium.bounds().empty()) finest = std::min(finest, medium.voxel_size());
  MajorantGrid majorants = majorant_cells(box, finest);
  raise_majorants(media, majorants);
  return majorants;
}

}  // namespace

Medium::Medium(std::shared_ptr<const VoxelGrid> grid, const Affine& scene_from_index, const MediumOptions& options)
    : grid_(std::move(grid)), scene_from_index_(scene_from_index), options_(options) {
  if (!(std::abs(scene_from_index.determinant()) > 0) || !std::isfinite(scene_from_index.determinant()))
    throw std::invalid_argument("a transform that flattens the medium");
  if (!(options.sigma_t >= 0) || !std::isfinite(options.sigma_t) || !(std::abs(options.g) < 1) ||
      !(min_component(options.albedo) >= 0) || !(max_component(options.albedo) <= 1))
    throw std::invalid_argument("options of a medium out of range");
  index_from_scene_ = inverse(scene_from_index);
  for (std::size_t a = 0; a < 3; ++a) row_[a] = Vec3(index_from_scene_.row[a]);
  offset_ = Vec3(index_from_scene_.translation);
  if (!grid_->empty() && options.sigma_t > 0) bounds_ = transformed(scene_from_index, grid_->support());
}

float Medium::largest_extinction(const Box3d& box) const {
  if (bounds_.empty()) return 0;
  Box3d part{max(box.lower, bounds_.lower), min(box.upper, bounds_.upper)};
  if (part.empty()) return 0;
  return grid_->largest(transformed(index_from_scene_, part)) * options_.sigma_t;
}

double Medium::optical_depth(Vec3 origin, Vec3 direction, double length) const {
  if (bounds_.empty()) return 0;
  const Vec3d from = index_from_scene_.point(Vec3d(origin)), along = index_from_scene_.direction(Vec3d(direction));
  double begin = 0, end = 0;
  if (!clip(grid_->support(), from, along, length, begin, end)) return 0;
  // The line is cut at the planes of whole coordinates; between them the density is a cubic in t.
  Vec3d next{INFINITY, INFINITY, INFINITY}, step{INFINITY, INFINITY, INFINITY};
  for (int a = 0; a < 3; ++a) {
    if (along[a] == 0) continue;
    const double place = from[a] + along[a] * begin;
    const double plane = along[a] > 0 ? std::floor(place) + 1 : std::ceil(place) - 1;
    step[a] = 1 / std::abs(along[a]);
    next[a] = (plane - from[a]) / along[a];
  }
  constexpr double kGauss = 0.21132486540518711775;  // (1 - 1/sqrt(3)) / 2
  double sum = 0;
  while (begin < end) {
    const int a = next.x <= next.y ? (next.x <= next.z ? 0 : 2) : (next.y <= next.z ? 1 : 2);
    const double stop = std::min(end, next[a]), size = stop - begin;
    if (size > 0) {
      const float low = grid_->at(Vec3(from + along * (begin + kGauss * size)));
      const float high = grid_->at(Vec3(from + along * (stop - kGauss * size)));
      sum += 0.5 * size * (double(low) + double(high));
    }
    begin = std::max(begin, stop);
    next[a] += step[a];
  }
  return sum * options_.sigma_t;
}

double Medium::voxel_size() const {
  double least = INFINITY;
  for (const Vec3d axis : {Vec3d{1, 0, 0}, Vec3d{0, 1, 0}, Vec3d{0, 0, 1}})
    least = std::min(least, length(scene_from_index_.direction(axis)));
  return least;
}

std::string Medium::hash() const {
  Hasher hasher;
  hasher.add(std::string_view(grid_->hash()));
  hasher.add(scene_from_index_);
  hasher.add(options_.sigma_t);
  hasher.add(options_.albedo);
  hasher.add(options_.g);
  return hasher.hex();
}

Media::Media(std::vector<Medium> media) : media_(std::move(media)), majorants_(own_majorants(media_)) {}

Media::Media(std::vector<Medium> media, MajorantGrid frozen) : media_(std::move(media)), majorants_(std::move(frozen)) {
  const Box3d box = joint_bounds(media_);
  if (box.empty()) return;
  if (majorants_.empty() || length(max(Vec3d(majorants_.box().lower) - box.lower, Vec3d{})) > 0 ||
      length(max(box.upper - Vec3d(majorants_.box().upper), Vec3d{})) > 0)
    throw std::invalid_argument("the media reach beyond the box of the majorants");
  MajorantGrid raised = majorants_;
  raise_majorants(media_, raised);
  if (raised.values() != majorants_.values()) throw std::invalid_argument("the media exceed the majorants");
}

const Medium& Media::collided(Vec3 point, float u) const {
  if (media_.size() == 1) return media_.front();
  float left = u * extinction(point);
  const Medium* last = &media_.front();
  for (const Medium& medium : media_) {
    const float share = medium.extinction(point);
    if (share > 0) last = &medium;
    if (left < share) return medium;
    left -= share;
  }
  return *last;
}

double Media::optical_depth(Vec3 origin, Vec3 direction, double length) const {
  double sum = 0;
  for (const Medium& medium : media_) sum += medium.optical_depth(origin, direction, length);
  return sum;
}

bool Media::directional() const {
  return std::ranges::any_of(media_, [](const Medium& medium) { return medium.options().g != 0; });
}

std::string Media::hash() const {
  Hasher hasher;
  hasher.add(std::string_view("media 1"));
  for (const Medium& medium : media_) hasher.add(std::string_view(medium.hash()));
  return hasher.hex();
}

MajorantGrid majorant_cells(const Box3d& box, double finest_voxel) {
  constexpr double kVoxels = 8;  // voxels along a cell: 16^3 cells for 128^3 voxels were fastest
  const Box3 outer = outwards(box);
  const Vec3d size = Vec3d(outer.upper) - Vec3d(outer.lower);
  const double most = double(MajorantGrid::kMostCells);
  // A cell is larger than eight voxels if there would be too many cells.
  double edge = std::max(kVoxels * finest_voxel, max_component(size) * 1e-6);
  std::array<std::int32_t, 3> counts{};
  for (;; edge *= 1.25) {
    double cells = 1;
    for (std::size_t a = 0; a < 3; ++a) cells *= std::max(1.0, std::ceil(size[int(a)] / edge - 1e-6));
    if (cells > most) continue;
    for (std::size_t a = 0; a < 3; ++a) counts[a] = std::int32_t(std::max(1.0, std::ceil(size[int(a)] / edge - 1e-6)));
    return MajorantGrid(outer, counts);
  }
}

void raise_majorants(std::span<const Medium> media, MajorantGrid& majorants) {
  if (majorants.empty()) return;
  const auto [nx, ny, nz] = majorants.counts();
  // Rounding may assign a point on a border to either of two cells, so every cell is widened a little.
  const double hair =
      1e-5 * double(max_component(majorants.box().upper - majorants.box().lower)) / std::max({nx, ny, nz});
  parallel_chunks(std::size_t(nx) * std::size_t(ny), 16, [&, ny = ny, nz = nz](std::size_t first, std::size_t last) {
    for (std::size_t column = first; column < last; ++column)
      for (std::int32_t z = 0; z < nz; ++z) {
        Box3d cell = majorants.cell(std::int32_t(column / std::size_t(ny)), std::int32_t(column % std::size_t(ny)), z);
        cell.lower -= Vec3d{hair, hair, hair};
        cell.upper += Vec3d{hair, hair, hair};
        float sum = 0;
        for (const Medium& medium : media) sum += medium.largest_extinction(cell);
        float& value = majorants.values()[column * std::size_t(nz) + std::size_t(z)];
        value = std::max(value, sum);
      }
  });
}

}  // namespace tempolux
