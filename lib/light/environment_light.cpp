#include "lib/light/environment_light.h"

#include <algorithm>
#include <cmath>

#include "lib/core/parallel.h"
#include "lib/core/parallel_each.h"
#include "lib/core/pi.h"
#include "lib/light/linear_density.h"

namespace tempolux {
namespace {

constexpr double kUnits = 4294967295.0;  ///< largest cumulative share that 32 bits hold

}  // namespace

Rgb EnvironmentLight::Corners::radiance(double x, double y) const {
  const float fx = float(x), fy = float(y);
  return (upper_left * (1 - fx) + upper_right * fx) * (1 - fy) + (lower_left * (1 - fx) + lower_right * fx) * fy;
}

double EnvironmentLight::Luminances::at(double x, double y) const {
  return lerp(lerp(upper_left, upper_right, x), lerp(lower_left, lower_right, x), y);
}

EnvironmentLight::Luminances EnvironmentLight::luminances(const Corners& corners) {
  const auto l = [](const Rgb& pixel) { return luminance(Rgbd(pixel)); };
  return {l(corners.upper_left), l(corners.upper_right), l(corners.lower_left), l(corners.lower_right)};
}

EnvironmentLight::EnvironmentLight(const Environment& environment)
    : environment_(environment), width_(std::uint32_t(environment.width)), height_(std::uint32_t(environment.height)) {
  integrate();
  build_distribution();
}

double EnvironmentLight::polar(std::uint32_t row) const {
  return row == 0 ? 0 : row > height_ ? kPiD : (row - 0.5) * kPiD / height_;
}

EnvironmentLight::Corners EnvironmentLight::corners(std::uint32_t row, std::uint32_t column) const {
  const std::size_t upper = std::size_t(row == 0 ? 0 : row - 1) * width_;
  const std::size_t lower = std::size_t(std::min(row, height_ - 1)) * width_;
  const std::size_t right = column + 1 == width_ ? 0 : column + 1;
  const std::vector<Rgb>& pixels = environment_.radiance;
  return {pixels[upper + column], pixels[upper + right], pixels[lower + column], pixels[lower + right]};
}

/// Integrates radiance over the sphere. Between two rows of pixels at the polar angles a and b, the mean radiance over
/// all longitudes is (1 - t) first + t second, where first and second are the means of both rows' pixels. The weights
/// of both rows are int (1 - t) sin = cos a - (sin b - sin a) / (b - a) and int t sin = (sin b - sin a) / (b - a) -
/// cos b.
void EnvironmentLight::integrate() {
  std::vector<double> weight(height_, 0.0);
  for (std::uint32_t row = 0; row <= height_; ++row) {
    const double a = polar(row), b = polar(row + 1), slope = (std::sin(b) - std::sin(a)) / (b - a);
    weight[row == 0 ? 0 : row - 1] += std::cos(a) - slope;
    weight[std::min(row, height_ - 1)] += slope - std::cos(b);
  }
  std::vector<Rgbd> mean(height_);
  parallel_each(height_, 16, [&](std::size_t y) {
    Rgbd sum;
    for (std::uint32_t x = 0; x < width_; ++x) sum += Rgbd(environment_.radiance[y * width_ + x]);
    mean[y] = sum / double(width_);
  });
  for (std::uint32_t y = 0; y < height_; ++y) integral_ += mean[y] * (2 * kPiD * weight[y]);
}

bool EnvironmentLight::has_sun() const {
  constexpr double kSunMeans = 64 / 0.18, kSunShare = 0.02;
  const double all = luminance(integral_), bright = kSunMeans * all / (4 * kPiD);
  const double pixel = 2 * kPiD / width_ * kPiD / height_;
  double light = 0;
  for (std::uint32_t y = 0; y < height_; ++y) {
    const double sin_polar = std::sin((y + 0.5) * kPiD / height_);
    for (std::uint32_t x = 0; x < width_; ++x) {
      const double l = luminance(Rgbd(environment_.radiance[std::size_t(y) * width_ + x]));
      if (l > bright) light += l * pixel * sin_polar;
    }
  }
  return light > kSunShare * all;
}

void EnvironmentLight::build_distribution() {
  std::vector<double> row_weight(height_ + 1);
  cell_end_.resize(std::size_t(height_ + 1) * width_);
  parallel_chunks(height_ + 1, 16, [&](std::size_t first, std::size_t last) {
    std::vector<double> weight(width_), upper(width_ + 1), lower(width_ + 1);
    const auto take_row = [&](std::size_t y, std::vector<double>& to) {
      for (std::uint32_t x = 0; x < width_; ++x) to[x] = luminance(Rgbd(environment_.radiance[y * width_ + x]));
      to[width_] = to[0];
    };
    take_row(first == 0 ? 0 : first - 1, lower);
    for (std::size_t row = first; row < last; ++row) {
      std::swap(upper, lower);
      take_row(std::min<std::size_t>(row, height_ - 1), lower);
      double sum = 0;
      for (std::uint32_t x = 0; x < width_; ++x)
        sum += weight[x] = Luminances{upper[x], upper[x + 1], lower[x], lower[x + 1]}.at(0.5, 0.5);
      const double a = polar(std::uint32_t(row)), b = polar(std::uint32_t(row) + 1);
      row_weight[row] = sum * (std::cos(a) - std::cos(b));
      const double scale = sum > 0 ? (kUnits - width_) / sum : 0;
      std::uint32_t end = 0;
      for (std::uint32_t x = 0; x < width_; ++x) {
        if (weight[x] > 0) end += std::uint32_t(weight[x] * scale) + 1;
        cell_end_[row * width_ + x] = end;
      }
    }
  });
  double total = 0, sum = 0;
  for (const double w : row_weight) total += w;
  row_end_.reserve(row_weight.size());
  for (const double w : row_weight) row_end_.push_back(total > 0 ? (sum += w) / total : 0);
}

/// The row of cells whose part of [0, 1) holds u1.
std::uint32_t EnvironmentLight::row_for(double u1) const {
  return std::uint32_t(std::upper_bound(row_end_.begin(), row_end_.end() - 1, u1) - row_end_.begin());
}

std::uint32_t EnvironmentLight::column_for(std::uint32_t row, double u2) const {
  const std::uint32_t *ends = &cell_end_[std::size_t(row) * width_], *const last = ends + width_ - 1;
  return std::uint32_t(std::upper_bound(ends, last, std::uint32_t(u2 * *last)) - ends);
}

EnvironmentLight::Place EnvironmentLight::place_of(Vec3 direction) const {
  const Vec3& d = direction;
  // Single precision is enough: the error is a thousandth of a pixel in a map of 8192 columns.
  const auto polar_angle = double(std::atan2(std::sqrt(d.x * d.x + d.z * d.z), d.y));
  const double longitude = double(std::atan2(d.x, d.z)) - environment_.rotation_rad;
  // Position along the row in columns, counted from the first column's centre, in [0, width).
  double along = (0.5 - longitude / (2 * kPiD)) * width_ - 0.5;
  along -= std::floor(along / width_) * width_;
  // Position in rows of cells from the pole +Y. The first and last row of cells are half as high as the others.
  const double down = polar_angle / kPiD * height_ + 0.5;
  Place place{std::min(std::uint32_t(down), height_), std::min(std::uint32_t(along), width_ - 1), 0, 0};
  place.x = std::clamp(along - place.column, 0.0, 1.0);
  place.y = std::clamp(down - place.row, 0.0, 1.0);
  return place;
}

double EnvironmentLight::probability(std::uint32_t row, std::uint32_t column) const {
  const double of_row = row_end_[row] - (row > 0 ? row_end_[row - 1] : 0);
  const std::uint32_t* ends = &cell_end_[std::size_t(row) * width_];
  const std::uint32_t all = ends[width_ - 1], cell = ends[column] - (column > 0 ? ends[column - 1] : 0);
  return all > 0 ? of_row * cell / all : 0;
}

/// The luminance of a cell in the first or last row does not vary with latitude, so `across` is uniform over the area
/// there. In other cells the pdf is bilinear over longitude and latitude.
double EnvironmentLight::pdf_solid_angle(const Place& place, const Luminances& at, double sin_polar) const {
  const double of_cell = probability(place.row, place.column);
  if (!(of_cell > 0)) return 0;
  const double a = polar(place.row), b = polar(place.row + 1), width = 2 * kPiD / width_;
  const double shape = at.at(place.x, place.y) / at.at(0.5, 0.5);
  const double area = polar_cap(place.row) ? std::cos(a) - std::cos(b) : (b - a) * sin_polar;
  return of_cell * shape / (area * width);
}

bool EnvironmentLight::sample(double u1, double u2, Sample& sample) const {
  if (!(row_end_.back() > 0)) return false;
  std::uint32_t row = row_for(u1);
  while (row > 0 && !(row_end_[row] > row_end_[row - 1])) --row;
  const double row_first = row > 0 ? row_end_[row - 1] : 0;
  const std::uint32_t* ends = &cell_end_[std::size_t(row) * width_];
  const double units = u2 * ends[width_ - 1];
  const std::uint32_t column = column_for(row, u2);
  const double first = column > 0 ? ends[column - 1] : 0;

  // First draws the position along the row, from the luminances of the cell's left and right side; then the position
  // across the row.
  const Corners pixels = corners(row, column);
  const Luminances at = luminances(pixels);
  Place place{row, column, 0, 0};
  const double along = std::clamp((units - first) / (ends[column] - first), 0.0, 1.0);
  const double across = std::clamp((u1 - row_first) / (row_end_[row] - row_first), 0.0, 1.0);
  place.x = sample_linear(at.at(0, 0.5), at.at(1, 0.5), along);
  const double a = polar(row), b = polar(row + 1);
  double angle;
  if (polar_cap(row)) {
    // The cosine of the angle from the cap's own pole is uniform. Its half angle's sine keeps the digits of small
    // angles.
    const double half = std::sqrt(row == 0 ? across : 1 - across) * std::sin(0.5 * (b - a));
    angle = row == 0 ? 2 * std::asin(half) : kPiD - 2 * std::asin(half);
    place.y = (angle - a) / (b - a);
    if (row == 0) place.y = 0.5 + 0.5 * place.y;
  } else {
    place.y = sample_linear(at.at(place.x, 0), at.at(place.x, 1), across);
    angle = lerp(a, b, place.y);
  }
  const double longitude = (0.5 - (column + 0.5 + place.x) / width_) * 2 * kPiD + environment_.rotation_rad;
  const double sine = std::sin(angle);
  sample.direction = Vec3(Vec3d{std::sin(longitude) * sine, std::cos(angle), std::cos(longitude) * sine});
  sample.radiance = pixels.radiance(place.x, place.y);
  sample.pdf_solid_angle = pdf_solid_angle(place, at, sine);
  return sample.pdf_solid_angle > 0 && sample.pdf_solid_angle < INFINITY;
}

double EnvironmentLight::pdf_solid_angle(const Place& place, Vec3 direction) const {
  const Vec3d d(direction);
  return pdf_solid_angle(place, luminances(corners(place.row, place.column)), std::sqrt(d.x * d.x + d.z * d.z));
}

}  // namespace tempolux
