#include "formats/lightgrid/lightgrid.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <tuple>

#include "formats/container.h"
#include "formats/hash.h"

namespace tempolux::formats {
namespace {

constexpr Format kFormat{{"\x89TLGRD\r\n", 8}, ".lightgrid", "frame-render --learn-lights"};
constexpr std::string_view kBlockMark = "CELL";
constexpr std::size_t kEndBodySize = 8, kCellsInBlock = 1024,
                      kFixedSize = 24;     // of a record: 24 bytes and one float for each part
constexpr std::uint32_t kMostParts = 256;  ///< across, and down

/// What is wrong with the values, as the reader and the writer both see it; "" if nothing.
std::string_view fault_of(const LightgridHeader& h) {
  if (!(h.edge > 0) || !std::isfinite(h.edge)) return "edge is not a length";
  for (const std::uint32_t parts : h.parts)
    if (parts < 1 || parts > kMostParts) return "parts are not 1 to 256 across and down";
  return fault_of_common(h.origin, h.identity);
}

std::string header_text(const LightgridHeader& h) {
  HeaderText text("lightgrid");
  if (const std::string_view fault = fault_of(h); !fault.empty()) text.refuse(fault);
  text.origin(h.origin);
  text.line("edge", text_of(h.edge));
  text.line("parts", std::to_string(h.parts[0]) + " " + std::to_string(h.parts[1]));
  text.identity(h.identity);
  text.history(h.history);
  return text.finish();
}

std::optional<HeaderError> parse_header_text(std::string_view text, bool allow_unknown, LightgridHeader& h) {
  h = LightgridHeader();
  constexpr std::array<std::string_view, 3> required{"origin", "edge", "parts"};
  const auto take = [&](std::string_view key, std::string_view value) {
    if (key == "edge") return parse_numbers(value, &h.edge, 1) ? Line::good : Line::bad_value;
    if (key == "parts") return parse_numbers(value, h.parts.data(), 2) ? Line::good : Line::bad_value;
    return take_common_line(key, value, common_keys(h));
  };
  if (auto error = parse_lines(text, allow_unknown, required, take)) return error;
  if (const std::string_view fault = fault_of(h); !fault.empty())
    return HeaderError{0, "header: " + std::string(fault)};
  return std::nullopt;
}

bool is_share(float x) { return x >= 0 && x <= 1; }

/// The rules of lightgrid.md, section 3, for one cell after the other.
class Checked {
 public:
  explicit Checked(std::size_t parts) : parts_(parts) {}
  /// "" if the cell may follow those before.
  std::string_view add(const LightgridCell& cell) {
    for (const std::int32_t x : cell.place)
      if (x < -LightgridCell::kFarthest || x > LightgridCell::kFarthest) return "place is more than 524286 from 0";
    if (cell.facing > 5) return "facing is above 5";
    if (!is_share(cell.sky) || !is_share(cell.suns) || cell.sky + cell.suns > 1 + 0x1p-20f)
      return "sky and suns are not probabilities";
    if (cell.end.size() != parts_) return "end has not the number of parts";
    for (std::size_t i = 0; i < parts_; ++i)
      if (!is_share(cell.end[i]) || (i > 0 && cell.end[i] < cell.end[i - 1])) return "end does not ascend from 0 to 1";
    if (cell.end.back() != 1) return "end does not end at 1";
    const std::tuple place{cell.place, cell.facing};
    if (count_ > 0 && place <= last_) return "cells are not in the order of places and facings";
    last_ = place;
    ++count_;
    return "";
  }
  std::uint64_t count() const { return count_; }

 private:
  std::tuple<std::array<std::int32_t, 3>, std::uint32_t> last_{};
  std::size_t parts_;
  std::uint64_t count_ = 0;
};

std::string bytes_of(const LightgridCell& cell) {
  std::string bytes;
  put_array(bytes, std::span<const std::int32_t>(cell.place));
  put(bytes, cell.facing);
  put(bytes, cell.sky);
  put(bytes, cell.suns);
  put_array(bytes, std::span<const float>(cell.end));
  return bytes;
}

LightgridCell cell_of(const char* bytes, std::size_t parts) {
  LightgridCell cell;
  for (std::size_t c = 0; c < 3; ++c) cell.place[c] = get<std::int32_t>(bytes + 4 * c);
  cell.facing = get<std::uint32_t>(bytes + 12);
  cell.sky = get<float>(bytes + 16);
  cell.suns = get<float>(bytes + 20);
  for (std::size_t i = 0; i < parts; ++i) cell.end.push_back(get<float>(bytes + kFixedSize + 4 * i));
  return cell;
}

}  // namespace

void write_lightgrid(const std::function<void(const void*, std::size_t)>& sink, const LightgridFile& file) {
  Checked checked(file.header.part_count());
  for (const LightgridCell& cell : file.cells)
    if (const std::string_view fault = checked.add(cell); !fault.empty())
      throw std::invalid_argument("write_lightgrid: " + std::string(fault));
  ContainerWriter out(sink, kFormat, header_text(file.header));
  const std::span<const LightgridCell> all = file.cells;
  for (std::size_t first = 0; first < all.size(); first += kCellsInBlock) {
    const auto some = all.subspan(first, std::min(all.size() - first, kCellsInBlock));
    std::string body;
    for (const LightgridCell& cell : some) body += bytes_of(cell);
    out.write_block(kBlockMark, {std::uint32_t(some.size())}, body);
  }
  std::string end;
  put(end, checked.count());
  out.finish(end);
}

LightgridFile load_lightgrid(const std::string& path) {
  ContainerReader in(path, kFormat);
  LightgridFile file;
  in.expect_good(parse_header_text(in.text(), in.later_minor(), file.header));
  const std::size_t parts = file.header.part_count(), size = kFixedSize + sizeof(float) * parts;
  Checked checked(parts);
  std::vector<char> body;
  while (in.read_records(kBlockMark, size, body))
    for (std::size_t at = 0; at < body.size(); at += size) {
      file.cells.push_back(cell_of(body.data() + at, parts));
      if (const std::string_view fault = checked.add(file.cells.back()); !fault.empty())
        in.bytes().fail(in.body_offset() + at, std::string(fault), "correct the program that wrote it");
    }
  const std::string end = in.read_end(kEndBodySize);
  if (get<std::uint64_t>(end.data()) != checked.count())
    in.bytes().fail(in.body_offset(), "end block does not count the file's cells");
  in.bytes().expect_end();
  return file;
}

std::string digest_of(const LightgridFile& file) {
  Hasher cells;
  for (const LightgridCell& cell : file.cells) {
    const std::string bytes = bytes_of(cell);
    cells.add_bytes(bytes.data(), bytes.size());
  }
  return hash_hex("lightgrid: 1\norigin: " + hex_of(file.header.origin) +
                  "\nedge: " + hex_of(std::span(&file.header.edge, 1)) +
                  "\nparts: " + std::to_string(file.header.parts[0]) + " " + std::to_string(file.header.parts[1]) +
                  "\ncells: " + std::to_string(file.cells.size()) + " #" + cells.hex() + "\n");
}

}  // namespace tempolux::formats
