// lib/light/environment_light.h -- the environment as a light: evaluates radiance by direction and samples directions
// by radiance.
#pragma once

#include <cstdint>
#include <vector>

#include "lib/core/vec.h"
#include "lib/scene/environment.h"

namespace tempolux {

/// Samples directions of an environment map. A cell lies between the centres of four neighbouring pixels; radiance is
/// bilinear in longitude and latitude inside a cell. The cells of the first and last row reach to the poles. A cell is
/// drawn in proportion to the mean luminance of its corners times its solid angle; a direction inside the cell is drawn
/// in proportion to its bilinear luminance. A direction of pdf 0 is black. radiance / pdf is nearly constant, so light
/// samples have little noise: only colour varies, and sin(polar angle) within a cell.
class EnvironmentLight {
 public:
  /// The environment must outlive this object. Memory: 4 bytes per pixel.
  explicit EnvironmentLight(const Environment& environment);

  /// A place in the map: the cell (row, column), and the position (x, y) inside the cell, in [0, 1]. A caller that
  /// needs several values for one direction computes its place once.
  struct Place {
    std::uint32_t row, column;
    double x, y;
  };
  /// The place of a direction (unit, towards the environment).
  Place place_of(Vec3 direction) const;
  /// Radiance [W/m^2/sr] that arrives from `direction` (unit).
  Rgb radiance(Vec3 direction) const { return radiance_at(place_of(direction)); }
  /// Radiance [W/m^2/sr] at a place.
  Rgb radiance_at(const Place& place) const { return corners(place.row, place.column).radiance(place.x, place.y); }
  /// Integral of radiance over all directions [W/m^2], in closed form.
  Rgbd integral() const { return integral_; }
  /// True if at least 2 % of the light comes from pixels so bright that one of 64 samples of a screen pixel that meets
  /// such a place, by way of glass or a mirror, makes it white: paths show that light as lone dots. Radiance there is
  /// at least 64 / .18 times the mean over all directions. Pixels count with the solid angle at their centre.
  bool has_sun() const;

  struct Sample {
    Vec3 direction{};  ///< unit, towards the environment
    Rgb radiance{0.0f};
    double pdf_solid_angle = 0;  ///< [1/sr]
  };
  /// u1 in [0, 1) chooses the row of cells and, stretched, the position across the row. u2 in [0, 1) chooses the cell
  /// and the position along the row. False if the environment is black.
  bool sample(double u1, double u2, Sample& sample) const;
  /// pdf [1/sr] with which sample() gives `direction` (unit); `place` is its place.
  double pdf_solid_angle(const Place& place, Vec3 direction) const;

 private:
  /// Radiance at the corners of a cell, W/m^2/sr.
  struct Corners {
    const Rgb &upper_left, &upper_right, &lower_left, &lower_right;
    Rgb radiance(double x, double y) const;
  };
  /// Bilinear luminance in a cell, W/m^2/sr.
  struct Luminances {
    double upper_left, upper_right, lower_left, lower_right;
    double at(double x, double y) const;
  };
  static Luminances luminances(const Corners& corners);
  Corners corners(std::uint32_t row, std::uint32_t column) const;
  double polar(std::uint32_t row) const;  ///< polar angle from +Y of the upper edge of a row of cells
  bool polar_cap(std::uint32_t row) const { return row == 0 || row == height_; }
  double probability(std::uint32_t row, std::uint32_t column) const;
  double pdf_solid_angle(const Place& place, const Luminances& at, double sin_polar) const;
  std::uint32_t row_for(double u1) const;
  std::uint32_t column_for(std::uint32_t row, double u2) const;
  void integrate();
  void build_distribution();

  const Environment& environment_;
  std::uint32_t width_, height_;
  Rgbd integral_{0.0};
  std::vector<double> row_end_;  ///< cumulative probability of the height + 1 rows of cells
  /// Cumulative share of each cell in its row; a cell that emits has a share of at least 1
  std::vector<std::uint32_t> cell_end_;
};

}  // namespace tempolux
