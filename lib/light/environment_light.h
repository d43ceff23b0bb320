// lib/light/environment_light.h -- an environment as a light: radiance by direction, and directions by radiance.
#pragma once

#include <cstdint>
#include <vector>

#include "lib/core/guide.h"
#include "lib/core/vec.h"
#include "lib/scene/environment.h"

namespace tempolux {

/// Between the centres of four neighbouring pixels lies a cell, in which radiance is bilinear in longitude and
/// latitude; the cells of the first and last row reach to the poles. A cell is drawn in proportion to the mean
/// luminance at its corners times its solid angle, a direction in it in proportion to its bilinear luminance: what is
/// drawn with density zero is black, and radiance / density is the same everywhere but for colour and for the sine of
/// the polar angle, which the cell's mean stands for.
class EnvironmentLight {
 public:
  /// The environment must outlive it. Memory: 4 bytes per pixel and 260 per row. `even`: directions are drawn as if so
  /// many times the mean luminance were added everywhere: with 1, half of them fall evenly over the sphere.
  explicit EnvironmentLight(const Environment& environment, double even = 0);

  /// A place in the map: cell (row, column) and where in it, in [0, 1]. Several questions about one direction need it
  /// once.
  struct Place {
    std::uint32_t row, column;
    double x, y;
  };
  Place place_of(Vec3 direction) const;
  /// Arriving from `direction` (unit), W/m^2/sr.
  Rgb radiance(Vec3 direction) const { return radiance_at(place_of(direction)); }
  Rgb radiance_at(const Place& place) const { return corners(place.row, place.column).radiance(place.x, place.y); }
  /// Integral of radiance over all directions [W/m^2], closed form.
  Rgbd integral() const { return integral_; }

  struct Sample {
    Vec3 direction{};  ///< unit, towards where the light comes from
    Rgb radiance{0.0f};
    double pdf_solid_angle = 0;  ///< [1/sr]
  };
  /// u1 chooses the row of cells and, stretched, the place across it; u2 the cell and the place along it. In [0, 1).
  /// False if nothing is emitted.
  bool sample(double u1, double u2, Sample& sample) const;
  /// Density per solid angle of sample() at `direction`, to the rounding of its own arithmetic.
  double pdf_solid_angle(Vec3 direction) const { return pdf_solid_angle(place_of(direction), direction); }
  double pdf_solid_angle(const Place& place, Vec3 direction) const;
  /// The numbers (u1, u2) for which sample() gives this direction, but for rounding.
  Vec2 numbers_of(Vec3 direction) const { return numbers_of(place_of(direction), direction); }
  Vec2 numbers_of(const Place& place, Vec3 direction) const;

 private:
  struct Corners {
    const Rgb &upper_left, &upper_right, &lower_left, &lower_right;
    Rgb radiance(double x, double y) const;
  };
  /// Bilinear luminance in a cell, W/m^2/sr.
  struct Luminances {
    double upper_left, upper_right, lower_left, lower_right;
    double at(double x, double y) const;
  };
  Luminances luminances(const Corners& corners) const;
  Corners corners(std::uint32_t row, std::uint32_t column) const;
  double polar(std::uint32_t row) const;  ///< angle from +Y of a row's upper edge
  bool polar_cap(std::uint32_t row) const { return row == 0 || row == height_; }
  double probability(std::uint32_t row, std::uint32_t column) const;
  double pdf(const Place& place, const Luminances& at, double sin_polar) const;
  std::uint32_t row_for(double u1, Guide<64>::Range rows) const;
  std::uint32_t column_for(std::uint32_t row, double u2, Guide<64>::Range columns) const;
  void integrate();
  void build_distribution();

  const Environment& environment_;
  std::uint32_t width_, height_;
  double even_ = 0;  ///< W/m^2/sr, of the luminance that directions are drawn by
  Rgbd integral_{0.0};
  std::vector<double> row_end_;          ///< cumulative probability of the height + 1 rows of cells
  std::vector<std::uint32_t> cell_end_;  ///< cumulative within each row; what emits has 1 at least
  Guide<64> row_guide_;                  ///< of row_end_
  std::vector<Guide<64>> cell_guides_;   ///< of cell_end_, by row
};

}  // namespace tempolux
