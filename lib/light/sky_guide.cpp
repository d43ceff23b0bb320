// lib/light/sky_guide.cpp -- builds and samples a tree over places; each leaf has a pdf of sky directions.
#include "lib/light/sky_guide.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "lib/core/pi.h"
#include "lib/core/statistics.h"

namespace tempolux {
namespace {

/// Least extent of a grid in height and in azimuth [rad]: a thousandth of a picture's usual angle.
constexpr double kLeastExtent = 1e-3;
/// Part of the extent of its hits that a grid of a search adds on each side, and the uniform part of its density.
constexpr double kSearchMargin = 0.25, kSearchUniform = 0.5;

constexpr int kRows = SkyGuide::kRows, kColumns = SkyGuide::kColumns, kCells = kRows * kColumns;

/// Azimuth of a direction, in [0, 2 pi).
double azimuth(Vec3 d) {
  const double turn = std::atan2(double(d.z), double(d.x));
  return turn < 0 ? turn + 2 * kPiD : turn;
}

/// `turn` counted from `first`, in [0, 2 pi).
double turned(double turn, double first) { return turn < first ? turn - first + 2 * kPiD : turn - first; }

/// The azimuth behind the widest gap between azimuths, and the gap's width.
std::pair<double, double> widest_gap(std::vector<double> turns) {
  std::ranges::sort(turns);
  std::pair<double, double> widest{turns.front(), turns.front() + 2 * kPiD - turns.back()};
  for (std::size_t i = 1; i < turns.size(); ++i)
    if (const double gap = turns[i] - turns[i - 1]; gap > widest.second) widest = {turns[i], gap};
  return widest;
}

/// 0 to 5: the axis and sign that a normal is closest to.
std::size_t side_of(Vec3 n) {
  const float x = std::abs(n.x), y = std::abs(n.y), z = std::abs(n.z);
  if (x >= y && x >= z) return n.x < 0;
  return y >= z ? 2 + (n.y < 0) : 4 + (n.z < 0);
}

/// Index of the first entry of `ends` above u. Replaces u by its place inside that entry's part, stretched to [0, 1).
std::size_t find(std::span<const float> ends, double& u) {
  const auto after =
      std::upper_bound(ends.begin(), ends.end() - 1, u, [](double x, float end) { return x < double(end); });
  const auto i = std::size_t(after - ends.begin());
  const double below = i > 0 ? double(ends[i - 1]) : 0, width = double(ends[i]) - below;
  u = width > 0 ? std::clamp((u - below) / width, 0.0, 1 - 0x1p-53) : 0.5;
  return i;
}

}  // namespace

Vec3 SkyGuide::Grid::sample(double u1, double u2) const {
  const std::size_t row = find(row_end_, u1),
                    column = find(std::span(column_end_).subspan(row * kColumns, kColumns), u2);
  const double y = std::clamp(top_ - height_ * (double(row) + u1) / kRows, -1.0, 1.0),
               phi = first_ + turn_ * (double(column) + u2) / kColumns, across = std::sqrt(std::max(0.0, 1 - y * y));
  return {float(across * std::cos(phi)), float(y), float(across * std::sin(phi))};
}

double SkyGuide::Grid::pdf_solid_angle(Vec3 direction) const {
  const double down = top_ - double(direction.y), around = turned(azimuth(direction), first_);
  if (!(down >= 0 && down <= height_ && around <= turn_)) return 0;
  const int row = std::min(int(down / height_ * kRows), kRows - 1),
            column = std::min(int(around / turn_ * kColumns), kColumns - 1);
  return double(density_[std::size_t(row * kColumns + column)]);
}

/// Builds the tree over the places of one side.
struct SkyGuide::Builder {
  SkyGuide& guide;
  std::span<const Place> places;
  int rays;
  Use use;

  std::size_t least_hits() const { return use == Use::light ? kLeastHits : kSearchHits; }
  std::uint32_t build(std::span<std::uint32_t> of, std::span<Hit> hits) const;
  std::uint32_t leaf(std::span<const std::uint32_t> of, std::span<const Hit> hits) const;
  double sum_of_squares(const Grid& grid, std::span<const Hit> hits) const;
  double lamps_at(std::span<const std::uint32_t> of) const;
};

SkyGuide::Grid::Grid(std::span<const Hit> hits, Use use) {
  const double margin = use == Use::search ? kSearchMargin : 0,
               uniform = use == Use::search ? kSearchUniform : kUnguidedShare;
  double low = 1, high = -1;
  std::vector<double> turns;
  for (const Hit& hit : hits) {
    low = std::min(low, double(hit.direction.y));
    high = std::max(high, double(hit.direction.y));
    turns.push_back(azimuth(hit.direction));
  }
  const auto [first, gap] = widest_gap(turns);
  // A cell more on each side: the hits of a window lie within its edges. kLeastExtent keeps cells of equal hits apart.
  const double wider = 1 + 2 * margin, tall = std::max(high - low, kLeastExtent),
               wide = std::max(2 * kPiD - gap, kLeastExtent);
  height_ = tall * wider * kRows / (kRows - 2);
  top_ = std::min(1.0, high + tall * margin + height_ / kRows);
  height_ = std::min(height_, top_ + 1);
  turn_ = std::min(wide * wider * kColumns / (kColumns - 2), 2 * kPiD);
  first_ = first - (turn_ - wide) / 2;
  if (first_ < 0) first_ += 2 * kPiD;

  std::vector<double> weights(kCells, 0.0);
  double sum = 0;
  for (std::size_t k = 0; k < hits.size(); ++k) {
    const int row = std::clamp(int((top_ - double(hits[k].direction.y)) / height_ * kRows), 0, kRows - 1),
              column = std::clamp(int(turned(turns[k], first_) / turn_ * kColumns), 0, kColumns - 1);
    for (int i = -1; i <= 1; ++i)
      for (int j = -1; j <= 1; ++j) {
        const int r = std::clamp(row + i, 0, kRows - 1), c = std::clamp(column + j, 0, kColumns - 1);
        weights[std::size_t(r * kColumns + c)] += double(hits[k].weight) * (i == 0 ? 2 : 1) * (j == 0 ? 2 : 1);
      }
    sum += 16 * double(hits[k].weight);
  }
  for (double& weight : weights) weight = (1 - uniform) * weight + uniform * sum / kCells;

  double below = 0;
  for (int r = 0; r < kRows; ++r) {
    double row = 0, so_far = 0;
    for (int c = 0; c < kColumns; ++c) row += weights[std::size_t(r * kColumns + c)];
    for (int c = 0; c < kColumns; ++c) {
      const auto cell = std::size_t(r * kColumns + c);
      so_far += weights[cell];
      column_end_[cell] = row > 0 ? float(so_far / row) : 1;
    }
    below += row;
    row_end_[std::size_t(r)] = float(below / sum);
  }
  // sample() draws by shares that are rounded to float, so the pdf is computed from the rounded shares.
  for (int r = 0; r < kRows; ++r)
    for (int c = 0; c < kColumns; ++c) {
      const auto row = std::size_t(r), cell = std::size_t(r * kColumns + c);
      const double of_row = double(row_end_[row]) - (r > 0 ? double(row_end_[row - 1]) : 0),
                   of_cell = double(column_end_[cell]) - (c > 0 ? double(column_end_[cell - 1]) : 0);
      density_[cell] = float(of_row * of_cell * kCells / (height_ * turn_));
    }
}

/// Sum over the rays of (radiance cos)^2 over the pdfs of the ray and of a sample of the grid: the mean square of the
/// irradiance that one sample brings, times the number of rays.
double SkyGuide::Builder::sum_of_squares(const Grid& grid, std::span<const Hit> hits) const {
  double square = 0;
  for (const Hit& hit : hits) {
    const double cosine = std::max(0.0f, dot(places[hit.place].normal, hit.direction)),
                 pdf = (1 - kUnguidedShare) * grid.pdf_solid_angle(hit.direction);
    if (pdf > 0) square += double(hit.weight) * double(hit.weight / hit.share) * cosine * kPiD / pdf;
  }
  return square;
}

/// Part::lamps of these places.
double SkyGuide::Builder::lamps_at(std::span<const std::uint32_t> of) const {
  double lamps = 0, known = 0;
  for (const std::uint32_t i : of)
    if (places[i].lamps >= 0) lamps += double(places[i].lamps), ++known;
  return known > 0 ? std::sqrt(lamps / known) : 1;
}

std::uint32_t SkyGuide::Builder::leaf(std::span<const std::uint32_t> of, std::span<const Hit> hits) const {
  const double sent = double(of.size()) * rays;
  double seen = 0, weight = 0;
  for (const Hit& hit : hits) seen += double(hit.share), weight += double(hit.weight);
  guide.nodes_.push_back({-1, 0, std::uint32_t(guide.parts_.size()), 0});
  Part part;
  if (sent > 0) part.irradiance = kPiD * weight / sent;
  if (hits.size() >= least_hits() && seen <= kMostSeen * sent) {
    part.grid = std::uint32_t(guide.grids_.size());
    part.rms = std::sqrt(sum_of_squares(guide.grids_.emplace_back(hits, use), hits) / sent);
  }
  part.lamps = lamps_at(of);
  guide.parts_.push_back(part);
  return std::uint32_t(guide.nodes_.size() - 1);
}

/// Adds the node of these places and their hits, and all nodes below. Returns the node's number.
std::uint32_t SkyGuide::Builder::build(std::span<std::uint32_t> of, std::span<Hit> hits) const {
  if (hits.size() < 2 * least_hits()) return leaf(of, hits);
  const auto position = [&](const Hit& hit) { return places[hit.place].position; };
  Vec3 low = position(hits[0]), high = low;
  for (const Hit& hit : hits) {
    low = min(low, position(hit));
    high = max(high, position(hit));
  }
  const Vec3 size = high - low;
  const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
  std::vector<float> at;
  for (const Hit& hit : hits) at.push_back(position(hit)[axis]);
  std::ranges::nth_element(at, at.begin() + std::ptrdiff_t(at.size() / 2));
  const float split = at[at.size() / 2];
  // A stable partition keeps the order of the hits, so sums of weights do not depend on the library.
  const auto upper_hits =
      std::stable_partition(hits.begin(), hits.end(), [&](const Hit& hit) { return position(hit)[axis] < split; });
  const auto below = std::size_t(upper_hits - hits.begin());
  if (below < least_hits() / 2) return leaf(of, hits);  // many places have the same coordinate
  const auto upper_places =
      std::stable_partition(of.begin(), of.end(), [&](std::uint32_t i) { return places[i].position[axis] < split; });
  const auto places_below = std::size_t(upper_places - of.begin());
  const auto number = guide.nodes_.size();
  guide.nodes_.emplace_back();
  const std::uint32_t left = build(of.first(places_below), hits.first(below)),
                      right = build(of.subspan(places_below), hits.subspan(below));
  guide.nodes_[number] = {axis, split, left, right};
  return std::uint32_t(number);
}

SkyGuide::SkyGuide(std::span<const Place> places, std::vector<Hit> hits, int rays, Use use) {
  std::array<std::vector<std::uint32_t>, 6> places_of;
  std::array<std::vector<Hit>, 6> hits_of;
  for (std::size_t i = 0; i < places.size(); ++i) places_of[side_of(places[i].normal)].push_back(std::uint32_t(i));
  for (const Hit& hit : hits) hits_of[side_of(places[hit.place].normal)].push_back(hit);
  const Builder builder{*this, places, rays, use};
  for (std::size_t side = 0; side < 6; ++side) root_[side] = builder.build(places_of[side], hits_of[side]);
}

const SkyGuide::Part* SkyGuide::at(Vec3 position, Vec3 normal) const {
  if (parts_.empty() || normal == Vec3{}) return nullptr;
  std::uint32_t node = root_[side_of(normal)];
  while (nodes_[node].axis >= 0)
    node = position[nodes_[node].axis] < nodes_[node].split ? nodes_[node].left : nodes_[node].right;
  return &parts_[nodes_[node].left];
}

}  // namespace tempolux
