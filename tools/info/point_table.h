// tools/info/point_table.h -- points with their values as a table for other programs: PLY (binary) or CSV.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "tools/common/output.h"

namespace tempolux::tools {

/// Rows of: position [m, float64] and normal, columns of one's own [float32], then object and set. PLY has a
/// display colour after them, 0 to 255, so that a viewer shows the light.
class PointTable {
 public:
  /// One number, or three for the channels R, G, B; in a CSV the unit stands behind the name.
  struct Column {
    std::string name, unit;
    int channels;
  };

  /// `format` is "ply" or "csv"; `rows` is how many will be written.
  PointTable(const std::string& format, Output& output, std::uint64_t rows, const std::string& comment,
             const std::vector<Column>& columns);

  /// The next number of this row: x, y, z, the normal, then the columns.
  void add(double value);
  /// The next of R, G, B; left out of a CSV.
  void add_colour(std::uint8_t value) { colour_ += char(value); }
  void end_row(std::uint16_t object, std::uint8_t set);
  /// Writes what is left. To be called once, at the end.
  void finish();

 private:
  Output& output_;
  bool ply_;
  std::size_t column_ = 0;  ///< of this row, next to be added
  std::string text_, colour_;
};

}  // namespace tempolux::tools
