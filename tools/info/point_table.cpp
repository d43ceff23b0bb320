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

}  // namespace

PointTable::PointTable(const std::string& format, Output& output, std::uint64_t rows, const std::string& comment,
                       const std::vector<Column>& columns)
    : output_(output), ply_(format == "ply") {
  const auto add_fields = [&](const Column& column) {
    const std::string end = ply_ || column.unit.empty() ? "" : "_" + column.unit;
    for (const std::string& name : column.names) fields_.push_back({name + end, column.type, column.words});
  };
  add_fields({{"x", "y", "z"}, "m", "double"});
  add_fields({{"nx", "ny", "nz"}, ""});
  for (const Column& column : columns) add_fields(column);
  if (ply_)
    text_ =
        "ply\nformat binary_little_endian 1.0\ncomment " + comment + "\nelement vertex " + std::to_string(rows) + "\n";
  for (const Field& field : fields_)
    text_ +=
        ply_ ? "property " + field.type + " " + field.name + "\n" : (&field == &fields_[0] ? "" : ",") + field.name;
  text_ += ply_ ? "property uchar red\nproperty uchar green\nproperty uchar blue\nend_header\n" : "\n";
}

void PointTable::add(double value) {
  const Field& field = fields_[field_++];
  if (ply_) {
    if (field.type == "double") append_bytes(text_, value);
    else if (field.type == "float") append_bytes(text_, float(value));
    else if (field.type == "ushort") append_bytes(text_, std::uint16_t(value));
    else append_bytes(text_, std::uint8_t(value));
    return;
  }
  if (field_ > 1) text_ += ',';
  if (!field.words.empty()) {
    text_ += field.words.at(std::size_t(value));
    return;
  }
  char number[40];
  const int length = std::snprintf(number, sizeof number, "%.9g", value);
  text_.append(number, std::size_t(length));
}

void PointTable::end_row(const std::array<std::uint8_t, 3>& colour) {
  if (ply_) append_bytes(text_, colour);
  else text_ += '\n';
  field_ = 0;
  if (text_.size() < kPieceBytes) return;
  output_.write(text_.data(), text_.size());
  text_.clear();
}

void PointTable::finish() { output_.write(text_.data(), text_.size()); }

}  // namespace tempolux::tools
