#include "lib/compose/fluence_volume.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "lib/core/parallel.h"

namespace tempolux {
namespace {

using Cell = std::array<float, 4>;

constexpr float kWidest = 16;      ///< cells: widest automatic Gaussian
constexpr std::size_t kLine = 64;  ///< lines of cells that one task processes

/// Weights of a Gaussian for the cells in a line around the centre; their sum is 1.
std::vector<float> kernel(float width) {
  const int reach = int(std::ceil(3 * width));
  std::vector<float> weights;
  double sum = 0;
  for (int i = -reach; i <= reach; ++i) {
    weights.push_back(std::exp(-0.5f * float(i * i) / (width * width)));
    sum += double(weights.back());
  }
  for (float& w : weights) w = float(double(w) / sum);
  return weights;
}

/// Filters the cells along one axis. Cells outside the box have no sum and no volume.
void filter_axis(std::vector<Cell>& cells, const std::array<std::int32_t, 3>& counts, int axis,
                 const std::vector<float>& weights) {
  const std::size_t stride[3] = {std::size_t(counts[1]) * std::size_t(counts[2]), std::size_t(counts[2]), 1};
  const int other1 = axis == 0 ? 1 : 0, other2 = axis == 2 ? 1 : 2;
  const auto n = std::size_t(counts[std::size_t(axis)]), n1 = std::size_t(counts[std::size_t(other1)]),
             n2 = std::size_t(counts[std::size_t(other2)]);
  const auto reach = std::int64_t(weights.size() / 2);
  parallel_chunks(n1 * n2, kLine, [&](std::size_t first, std::size_t last) {
    std::vector<Cell> line(n);
    for (std::size_t l = first; l < last; ++l) {
      Cell* const base = cells.data() + l / n2 * stride[other1] + l % n2 * stride[other2];
      for (std::size_t i = 0; i < n; ++i) line[i] = base[i * stride[axis]];
      for (std::size_t i = 0; i < n; ++i) {
        Cell sum{};
        const std::int64_t from = std::max<std::int64_t>(0, std::int64_t(i) - reach),
                           to = std::min<std::int64_t>(std::int64_t(n) - 1, std::int64_t(i) + reach);
        for (std::int64_t j = from; j <= to; ++j) {
          const float w = weights[std::size_t(j - std::int64_t(i) + reach)];
          for (std::size_t c = 0; c < 4; ++c) sum[c] += w * line[std::size_t(j)][c];
        }
        base[i * stride[axis]] = sum;
      }
    }
  });
}

}  // namespace

FluenceSums::FluenceSums(const MajorantGrid& majorants, double cell, double emitted_flux) : box_(majorants.box()) {
  if (majorants.empty()) return;
  const Vec3 size = box_.upper - box_.lower;
  std::int32_t per = 1;
  const double edge = double(size.x) / majorants.counts()[0];
  if (cell > 0) per = std::int32_t(std::clamp(std::ceil(edge / cell - 1e-3), 1.0, 64.0));
  const auto cells_of = [&](std::int32_t k) { return double(majorants.values().size()) * k * k * k; };
  while (per > 1 && cells_of(per) > double(kMostCells)) --per;
  for (std::size_t a = 0; a < 3; ++a) {
    counts_[a] = majorants.counts()[a] * per;
    cells_per_m_[int(a)] = float(counts_[a]) / size[int(a)];
  }
  const double whole = std::max(emitted_flux, 1e-300) * double(length(size));
  unit_ = std::exp2(std::clamp(std::ceil(std::log2(whole)), -900.0, 900.0) - 44);
  const std::size_t cells = std::size_t(counts_[0]) * std::size_t(counts_[1]) * std::size_t(counts_[2]);
  sums_.resize(cells);
  open_.resize(cells);
  std::size_t i = 0;
  for (std::int32_t x = 0; x < counts_[0]; ++x)
    for (std::int32_t y = 0; y < counts_[1]; ++y)
      for (std::int32_t z = 0; z < counts_[2]; ++z, ++i)
        open_[i] =
            majorants.values()[(std::size_t(x / per) * std::size_t(majorants.counts()[1]) + std::size_t(y / per)) *
                                   std::size_t(majorants.counts()[2]) +
                               std::size_t(z / per)] > 0;
}

double FluenceSums::cell_volume() const {
  return 1 / (double(cells_per_m_.x) * double(cells_per_m_.y) * double(cells_per_m_.z));
}

std::size_t FluenceSums::cell_of(Vec3 point) const {
  std::size_t index = 0;
  for (std::size_t a = 0; a < 3; ++a) {
    const int i = int(a);
    const float place = (point[i] - box_.lower[i]) * cells_per_m_[i];
    if (!(place >= 0 && point[i] <= box_.upper[i])) return sums_.size();
    index = index * std::size_t(counts_[a]) + std::size_t(std::min(std::int32_t(place), counts_[a] - 1));
  }
  return index;
}

void FluenceSums::add(Vec3 point, Rgb contribution, int times) {
  const std::size_t cell = cell_of(point);
  if (cell >= sums_.size() || !is_finite(contribution)) return;
  // In unsigned numbers an overflow from a damaged file wraps, and is undone when the photon is subtracted.
  for (int c = 0; c < 3; ++c) {
    std::int64_t& sum = sums_[cell][std::size_t(c)];
    const auto more = std::uint64_t(std::llrint(std::clamp(double(contribution[c]) / unit_, -9e18, 9e18)));
    sum = std::int64_t(std::uint64_t(sum) + std::uint64_t(std::int64_t(times)) * more);
  }
  photons_ += std::uint64_t(std::int64_t(times));
}

FluenceVolume::FluenceVolume(const FluenceSums& sums, float width)
    : box_(sums.box()), counts_(sums.counts()), width_(width) {
  if (sums.sums().empty()) return;
  for (std::size_t a = 0; a < 3; ++a)
    cells_per_m_[int(a)] = float(counts_[a]) / (box_.upper[int(a)] - box_.lower[int(a)]);
  cells_.resize(sums.sums().size());
  const auto volume = float(sums.cell_volume());
  std::size_t open = 0;
  for (std::size_t i = 0; i < cells_.size(); ++i) {
    for (std::size_t c = 0; c < 3; ++c) cells_[i][c] = float(double(sums.sums()[i][c]) * sums.unit());
    cells_[i][3] = sums.open()[i] ? volume : 0;
    open += sums.open()[i];
  }
  if (!(width_ > 0)) {
    // A Gaussian of deviation s averages as many cells as (4 pi s^2)^(3/2).
    const double density = double(sums.photons()) / double(std::max<std::size_t>(1, open));
    width_ = std::clamp(
        float(std::cbrt(double(kPhotonsInFilter) / std::max(density, 1e-9)) / std::sqrt(4 * std::numbers::pi)), 0.25f,
        kWidest);
  }
  const std::vector<float> weights = kernel(width_);
  for (int axis = 0; axis < 3; ++axis) filter_axis(cells_, counts_, axis, weights);
}

Rgb FluenceVolume::at(Vec3 point) const {
  if (cells_.empty()) return Rgb(0.0f);
  std::array<std::size_t, 3> low, high;
  std::array<float, 3> part;
  for (std::size_t a = 0; a < 3; ++a) {
    const int i = int(a);
    if (!(point[i] >= box_.lower[i] && point[i] <= box_.upper[i])) return Rgb(0.0f);
    const float place = (point[i] - box_.lower[i]) * cells_per_m_[i] - 0.5f, whole = std::floor(place);
    low[a] = std::size_t(std::clamp(std::int32_t(whole), 0, counts_[a] - 1));
    high[a] = std::size_t(std::clamp(std::int32_t(whole) + 1, 0, counts_[a] - 1));
    part[a] = place - whole;
  }
  Cell sum{};
  for (int corner = 0; corner < 8; ++corner) {
    std::size_t index = 0;
    float w = 1;
    for (std::size_t a = 0; a < 3; ++a) {
      const bool upper = corner >> a & 1;
      index = index * std::size_t(counts_[a]) + (upper ? high[a] : low[a]);
      w *= upper ? part[a] : 1 - part[a];
    }
    for (std::size_t c = 0; c < 4; ++c) sum[c] += w * cells_[index][c];
  }
  if (!(sum[3] > 0)) return Rgb(0.0f);
  return Rgb(sum[0], sum[1], sum[2]) * (1 / sum[3]);
}

}  // namespace tempolux
