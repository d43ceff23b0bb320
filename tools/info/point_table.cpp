#include "tools/info/point_table.h"

#include <bit>
#include <cstdio>
#include <cstring>

namespace tempolux::tools {
namespace {

constexpr std::size_t kPieceBytes = 1 << 20;

template <class Value>
void append_bytes(std::string& to, const Value& value) {
  static_assert(std::endian::native == std::endian::little);
  char bytes[sizeof value];
  std::memcpy(bytes, &value, sizeof value);
  to.append(bytes, sizeof value);
}

/// Names such as "direct_r", "direct_g", "direct_b"; the plain name for a single number. `unit` is appended if given.
std::vector<std::string> names_of(const PointTable::Column& column, const std::string& unit) {
  const std::string end = unit.empty() ? "" : "_" + unit;
  if (column.channels == 1) return {column.name + end};
  return {column.name + "_r" + end, column.name + "_g" + end, column.name + "_b" + end};
}

std::string ply_header(std::uint64_t rows, const std::string& comment, const std::vector<PointTable::Column>& columns) {
  std::string text = "ply\nformat binary_little_endian 1.0\ncomment " + comment + "\nelement vertex " +
                     std::to_string(rows) + "\nproperty double x\nproperty double y\nproperty double z\n" +
                     "property float nx\nproperty float ny\nproperty float nz\n";
  for (const PointTable::Column& column : columns)
    for (const std::string& name : names_of(column, "")) text += "property float " + name + "\n";
  text += "property uchar red\nproperty uchar green\nproperty uchar blue\n";
  return text + "property ushort object\nproperty uchar set\nend_header\n";
}

std::string csv_header(const std::vector<PointTable::Column>& columns) {
  std::string text = "x_m,y_m,z_m,nx,ny,nz";
  for (const PointTable::Column& column : columns)
    for (const std::string& name : names_of(column, column.unit)) text += "," + name;
  return text + ",object,set\n";
}

}  // namespace

PointTable::PointTable(const std::string& format, Output& output, std::uint64_t rows, const std::string& comment,
                       const std::vector<Column>& columns)
    : output_(output), ply_(format == "ply"), text_(ply_ ? ply_header(rows, comment, columns) : csv_header(columns)) {}

void PointTable::add(double value) {
  const bool position = column_++ < 3;
  if (ply_ && position) return append_bytes(text_, value);
  if (ply_) return append_bytes(text_, float(value));
  char number[40];
  const int length = std::snprintf(number, sizeof number, "%.9g,", value);
  text_.append(number, std::size_t(length));
}

void PointTable::end_row(std::uint16_t object, std::uint8_t set) {
  if (ply_) {
    text_ += colour_;
    append_bytes(text_, object);
    append_bytes(text_, set);
  } else {
    text_ += std::to_string(object) + (set == 0 ? ",static\n" : ",dynamic\n");
  }
  column_ = 0;
  colour_.clear();
  if (text_.size() < kPieceBytes) return;
  output_.write(text_.data(), text_.size());
  text_.clear();
}

void PointTable::finish() { output_.write(text_.data(), text_.size()); }

}  // namespace tempolux::tools
