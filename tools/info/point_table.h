// tools/info/point_table.h -- writes points with their values as a table: PLY (binary) or CSV.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "tools/common/output.h"

namespace tempolux::tools {

/// Rows of position [m, float64] and normal, custom columns [float32], then object and set. PLY rows end with a display
/// colour, 0 to 255, so that a viewer shows the light.
class PointTable {
 public:
  /// One number, or three for the channels R, G, B; a CSV appends the unit to the name.
  struct Column {
    std::string name, unit;
    int channels;
  };

  /// `format` is "ply" or "csv"; `rows` is the number of rows that follow.
  PointTable(const std::string& format, Output& output, std::uint64_t rows, const std::string& comment,
             const std::vector<Column>& columns);

  /// Adds the next number of this row: x, y, z, the normal, then the columns.
  void add(double value);
  /// Adds the next of R, G, B; ignored in a CSV.
  void add_colour(std::uint8_t value) { colour_ += char(value); }
  void end_row(std::uint16_t object, std::uint8_t set);
  /// Writes the buffered rows. Call once, at the end.
  void finish();

 private:
  Output& output_;
  bool ply_;
  std::size_t column_ = 0;  ///< index of the next column in this row
  std::string text_, colour_;
};

}  // namespace tempolux::tools
