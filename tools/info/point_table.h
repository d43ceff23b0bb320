// tools/info/point_table.h -- writes points with their values as a table: PLY (binary) or CSV.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "tools/common/output.h"

namespace tempolux::tools {

/// Rows of position and normal, then custom columns. PLY rows end with a display colour, so that a viewer shows the
/// light.
class PointTable {
 public:
  /// The numbers of a column: their names, such as "flux_r"; the unit that a CSV appends; their type in PLY.
  struct Column {
    std::vector<std::string> names;
    std::string unit;
    const char* type = "float";           ///< float, ushort or uchar
    std::vector<std::string> words = {};  ///< what a CSV has in place of the numbers 0, 1, ...; empty: the numbers
  };
  /// The column `name` with one number for each channel: R, G, B.
  static Column channels(const std::string& name, const std::string& unit) {
    return {{name + "_r", name + "_g", name + "_b"}, unit};
  }

  /// `format` is "ply" or "csv"; `rows` is the number of rows that follow (PLY).
  PointTable(const std::string& format, Output& output, std::uint64_t rows, const std::string& comment,
             const std::vector<Column>& columns);

  /// Adds the next number of this row: x, y, z [m, float64], the normal, then the columns.
  void add(double value);
  template <class Number>
  void add(const std::array<Number, 3>& values) {
    for (const Number value : values) add(double(value));
  }
  /// Ends the row. colour: R, G, B, 0 to 255; a CSV has none.
  void end_row(const std::array<std::uint8_t, 3>& colour);
  /// Writes the buffered rows. Call once, at the end.
  void finish();

 private:
  /// One number of a row.
  struct Field {
    std::string name, type;
    std::vector<std::string> words;
  };

  Output& output_;
  bool ply_;
  std::vector<Field> fields_;
  std::size_t field_ = 0;  ///< index of the next number in this row
  std::string text_;
};

}  // namespace tempolux::tools
