#include "lib/volume/majorants.h"

#include <algorithm>
#include <cmath>
#include <span>
#include <stdexcept>

#include "formats/hash.h"

namespace tempolux {

MajorantGrid::MajorantGrid(const Box3& box, const std::array<std::int32_t, 3>& counts) : box_(box), counts_(counts) {
  std::uint64_t cells = 1;
  for (std::size_t a = 0; a < 3; ++a) {
    if (counts[a] < 1 || !(box.upper[int(a)] > box.lower[int(a)]))
      throw std::invalid_argument("majorants of an empty box");
    cells *= std::uint64_t(counts[a]);
    if (cells > kMostCells) throw std::invalid_argument("too many cells of majorants");
    cell_size_[int(a)] = (box.upper[int(a)] - box.lower[int(a)]) / float(counts[a]);
  }
  values_.assign(cells, 0.0f);
}

Box3d MajorantGrid::cell(std::int32_t x, std::int32_t y, std::int32_t z) const {
  Box3d cell;
  cell.add(Vec3d{plane(0, x), plane(1, y), plane(2, z)});
  cell.add(Vec3d{plane(0, x + 1), plane(1, y + 1), plane(2, z + 1)});
  return cell;
}

std::size_t MajorantGrid::index_of(Vec3 point) const {
  std::size_t index = 0;
  for (std::size_t a = 0; a < 3; ++a) {
    const int i = int(a);
    if (empty() || !(point[i] >= box_.lower[i] && point[i] <= box_.upper[i])) return values_.size();
    const float place = (point[i] - box_.lower[i]) / cell_size_[i];
    index = index * std::size_t(counts_[a]) + std::size_t(std::min(std::int32_t(place), counts_[a] - 1));
  }
  return index;
}

void MajorantGrid::raise_to(float least) {
  for (float& value : values_)
    if (value > 0) value = std::max(value, least);
}

float MajorantGrid::mean_chord() const {
  if (empty()) return 0;
  const Vec3 d = box_.upper - box_.lower;
  return 2 * d.x * d.y * d.z / (d.x * d.y + d.y * d.z + d.z * d.x);
}

std::string MajorantGrid::hash() const {
  Hasher hasher;
  hasher.add(std::string_view("majorants 1"));
  hasher.add(box_.lower);
  hasher.add(box_.upper);
  hasher.add(counts_);
  hasher.add_array(std::span<const float>(values_));
  return hasher.hex();
}

MajorantWalk::MajorantWalk(const MajorantGrid& grid, Vec3 origin, Vec3 direction, float length)
    : grid_(&grid), origin_(origin), begin_(0), end_(length) {
  if (grid.empty()) return;
  // A ray does not advance along an axis of a smaller component d: 1 / d would overflow, and 0 x infinity is NaN.
  constexpr float kAlong = 1e-30f;
  for (int a = 0; a < 3; ++a) {
    if (std::abs(direction[a]) < kAlong) {
      if (!(origin[a] >= grid.box_.lower[a] && origin[a] <= grid.box_.upper[a])) return;
      inverse_[a] = INFINITY;
      continue;
    }
    inverse_[a] = 1 / direction[a];
    float near = (grid.box_.lower[a] - origin[a]) * inverse_[a], far = (grid.box_.upper[a] - origin[a]) * inverse_[a];
    if (near > far) std::swap(near, far);
    begin_ = std::max(begin_, near);
    end_ = std::min(end_, far);
  }
  if (!(begin_ < end_)) return;
  inside_ = true;
  const Vec3 entry = origin + direction * begin_;
  for (int a = 0; a < 3; ++a) {
    const auto i = std::size_t(a);
    step_[i] = std::isinf(inverse_[a]) ? 0 : direction[a] > 0 ? 1 : -1;
    const float place = (entry[a] - grid.box_.lower[a]) / grid.cell_size_[a];
    cell_[i] = std::clamp(std::int32_t(std::clamp(place, 0.0f, 1e9f)), 0, grid.counts_[i] - 1);
    leave_[i] = crossing(a);
  }
}

float MajorantWalk::crossing(int axis) const {
  const auto i = std::size_t(axis);
  if (step_[i] == 0) return INFINITY;
  return (grid_->plane(axis, cell_[i] + (step_[i] > 0)) - origin_[axis]) * inverse_[axis];
}

bool MajorantWalk::next(Piece& piece) {
  if (!inside_) return false;
  const std::size_t axis = leave_[0] <= leave_[1] ? (leave_[0] <= leave_[2] ? 0 : 2) : (leave_[1] <= leave_[2] ? 1 : 2);
  piece.begin = begin_;
  piece.end = std::max(begin_, std::min(end_, leave_[axis]));  // rounding may put a plane before the entry point
  piece.majorant = grid_->values_[(std::size_t(cell_[0]) * std::size_t(grid_->counts_[1]) + std::size_t(cell_[1])) *
                                      std::size_t(grid_->counts_[2]) +
                                  std::size_t(cell_[2])];
  begin_ = piece.end;
  cell_[axis] += step_[axis];
  inside_ = leave_[axis] < end_ && cell_[axis] >= 0 && cell_[axis] < grid_->counts_[axis];
  if (inside_) leave_[axis] = crossing(int(axis));
  else piece.end = std::max(piece.end, end_);
  return true;
}

}  // namespace tempolux
