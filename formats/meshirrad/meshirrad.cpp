#include "formats/meshirrad/meshirrad.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <stdexcept>
#include <tuple>

#include "formats/container.h"
#include "formats/hash.h"

namespace tempolux::formats {
namespace {

constexpr Format kFormat{{"\x89TMESH\r\n", 8}, ".meshirrad", "st-filter mesh or gather-temporal density", 1, 1};
constexpr std::string_view kBlockMark = "MESH";
constexpr std::size_t kEndBodySize = 16;
constexpr std::uint16_t kHoldsSince = 1;                                         // minor version
constexpr std::array<std::string_view, 3> kHolds{"frame", "counts", "windows"};  // by MeshHolds

bool is_kinds(const std::string& list) {
  for (unsigned kinds = 1; kinds < 8; ++kinds) {
    std::string names;
    for (unsigned k = 0; k < 3; ++k)
      if ((kinds >> k) & 1)
        names.append(names.empty() ? "" : ",").append(std::array{"direct", "caustic", "indirect"}[k]);
    if (names == list) return true;
  }
  return false;
}

bool is_length(std::string_view text) {
  double width = 0;
  return parse_numbers(text, &width, 1) && width > 0 && std::isfinite(width);
}

bool is_filter(std::string_view text) {
  if (text == "none") return true;
  for (const std::string_view name : {"box ", "gaussian ", "bilateral "})
    if (text.starts_with(name)) return is_length(text.substr(name.size()));
  return false;
}

/// The earliest version that has all values of this header.
Format format_of(const MeshirradHeader& h) {
  Format format = kFormat;
  format.minor = h.holds == MeshHolds::frame ? 0 : kHoldsSince;
  return format;
}

/// Checks the values for both reader and writer: returns the fault, or "" if there is none.
std::string_view fault_of(const MeshirradHeader& h) {
  if (!is_kinds(h.kinds)) return "kinds is not a list of direct, caustic, indirect in this order";
  if (!(h.cell > 0) || !std::isfinite(h.cell)) return "cell is not a length";
  if (!(h.unit > 0) || !std::isfinite(h.unit)) return "unit is not a flux above 0";
  if (!is_filter(h.filter)) return "filter is not none, or box, gaussian or bilateral and a width";
  if (h.holds == MeshHolds::counts && h.filter != "none") return "counts have no filter";
  if (h.jump && h.holds != MeshHolds::counts) return "jump is of counts alone";
  return fault_of_common(h.origin, h.identity);
}

std::string header_text(const MeshirradHeader& h) {
  HeaderText text("meshirrad");
  if (const std::string_view fault = fault_of(h); !fault.empty()) text.refuse(fault);
  text.line("kinds", h.kinds);
  text.origin(h.origin);
  text.line("cell", text_of(h.cell));
  text.line("unit", text_of(h.unit));
  text.line("filter", h.filter);
  if (h.holds != MeshHolds::frame) text.line("holds", std::string(kHolds[std::size_t(h.holds)]));
  if (h.jump) text.line("jump", "yes");
  text.identity(h.identity);
  text.history(h.history);
  return text.finish();
}

Line take_line(std::string_view key, std::string_view value, std::uint16_t minor, MeshirradHeader& h) {
  const auto result = [](bool good) { return good ? Line::good : Line::bad_value; };
  if (key == "kinds") return h.kinds = value, Line::good;
  if (key == "filter") return h.filter = value, Line::good;
  if (key == "cell") return result(parse_numbers(value, &h.cell, 1));
  if (key == "unit") return result(parse_numbers(value, &h.unit, 1));
  if (key == "jump" && minor >= kHoldsSince) return h.jump = true, result(value == "yes");
  if (key == "holds" && minor >= kHoldsSince) {
    const auto found = std::ranges::find(kHolds, value);
    h.holds = MeshHolds(found - kHolds.begin());
    return result(found != kHolds.end());
  }
  return take_common_line(key, value, common_keys(h));
}

std::optional<HeaderError> parse_header_text(std::string_view text, std::uint16_t minor, MeshirradHeader& h) {
  h = MeshirradHeader();
  constexpr std::array<std::string_view, 5> required{"kinds", "origin", "cell", "unit", "filter"};
  const auto take = [&](std::string_view key, std::string_view value) { return take_line(key, value, minor, h); };
  if (auto error = parse_lines(text, minor > kFormat.minor, required, take)) return error;
  if (const std::string_view fault = fault_of(h); !fault.empty())
    return HeaderError{0, "header: " + std::string(fault)};
  return std::nullopt;
}

bool is_good(float x) { return std::isfinite(x) && x >= 0; }

/// Checks element after element by the rules of meshirrad.md, section 3.
class Checked {
 public:
  explicit Checked(MeshHolds holds) : holds_(holds) {}
  /// Adds an element: returns the fault, or "" if the element may follow the earlier ones.
  std::string_view add(const MeshElement& e) {
    if (e.cuts < 1 || e.cuts > kMostCuts) return "cuts is not in 1 .. 1024";
    if (e.side > 1) return "side is neither 0 nor 1";
    for (const float x : e.position)
      if (!std::isfinite(x)) return "position is not finite";
    if (e.normal[0] > 65534 || e.normal[1] > 65534) return "normal is above 65534";
    if (!is_good(e.area)) return "area is not finite or is negative";
    for (const float x : e.irradiance)
      if (!is_good(x)) return "irradiance is not finite or is negative";
    for (const std::int64_t sum : e.sums)
      if (sum < 0) return "a sum is negative";
    if (holds_ != MeshHolds::windows && (e.before != 0 || e.after != 0)) return "frames before or after are not 0";
    const std::tuple place{e.surface, e.triangle, e.side};
    const bool goes_on = next_cell_ > 0;
    if (goes_on ? place != last_ || e.cuts != cuts_ || e.cell != next_cell_
                : e.cell != 0 || (count_ > 0 && place <= last_))
      return "elements are not in the order of surfaces, triangles, sides and cells, all cells of a side";
    last_ = place;
    cuts_ = e.cuts;
    next_cell_ = e.cell + 1 == std::uint32_t(cuts_) * cuts_ ? 0 : e.cell + 1;
    ++count_;
    photons_ += e.photons;
    return "";
  }
  bool complete() const { return next_cell_ == 0; }
  std::uint64_t count() const { return count_; }
  std::uint64_t photons() const { return photons_; }

 private:
  MeshHolds holds_;
  std::tuple<std::uint32_t, std::uint32_t, std::uint16_t> last_{};
  std::uint32_t cuts_ = 0, next_cell_ = 0;
  std::uint64_t count_ = 0, photons_ = 0;
};

}  // namespace

MeshPlace mesh_place(std::uint32_t n, float u, float v) {
  // Rows run along lines of equal v. Row j has 2 (n - j) - 1 cells: upright triangles alternate with inverted ones.
  const float x = std::clamp(u, 0.0f, 1.0f) * float(n), y = std::clamp(v, 0.0f, 1.0f) * float(n);
  const std::uint32_t j = std::min(std::uint32_t(y), n - 1), i = std::min(std::uint32_t(x), n - 1 - j);
  const bool tip = i + j + 1 < n && (x - float(i)) + (y - float(j)) > 1;
  return {i, j, tip, x - float(i), y - float(j)};
}

std::uint32_t mesh_cell(std::uint32_t n, float u, float v) {
  const MeshPlace place = mesh_place(n, u, v);
  return place.row * (2 * n - place.row) + 2 * place.column + place.tip;
}

std::array<float, 2> mesh_cell_centre(std::uint32_t n, std::uint32_t cell) {
  std::uint32_t j = 0;
  while (cell >= (j + 1) * (2 * n - j - 1)) ++j;
  const std::uint32_t within = cell - j * (2 * n - j);
  const float third = within % 2 ? 2.0f / 3 : 1.0f / 3;
  return {(float(within / 2) + third) / float(n), (float(j) + third) / float(n)};
}

void write_meshirrad(const std::function<void(const void*, std::size_t)>& sink, const MeshirradFile& file) {
  Checked checked(file.header.holds);
  for (const MeshElement& element : file.elements)
    if (const std::string_view fault = checked.add(element); !fault.empty())
      throw std::invalid_argument("write_meshirrad: " + std::string(fault));
  if (!checked.complete()) throw std::invalid_argument("write_meshirrad: cells of the last triangle are missing");
  ContainerWriter out(sink, format_of(file.header), header_text(file.header));
  const std::span<const MeshElement> all = file.elements;
  for (std::size_t first = 0; first < all.size(); first += kMaxBlockCount) {
    const auto some = all.subspan(first, std::min<std::size_t>(all.size() - first, kMaxBlockCount));
    std::string body;
    put_array(body, some);
    out.write_block(kBlockMark, {std::uint32_t(some.size())}, body);
  }
  std::string end;
  put(end, checked.count());
  put(end, checked.photons());
  out.finish(end);
}

MeshirradFile load_meshirrad(const std::string& path) {
  ContainerReader in(path, kFormat);
  MeshirradFile file;
  in.expect_good(parse_header_text(in.text(), in.minor(), file.header));
  file.elements.reserve(in.bytes().size() / sizeof(MeshElement));
  Checked checked(file.header.holds);
  std::vector<char> body;
  while (in.read_records(kBlockMark, sizeof(MeshElement), body))
    for (std::size_t i = 0; i < body.size() / sizeof(MeshElement); ++i) {
      file.elements.push_back(get<MeshElement>(body.data() + i * sizeof(MeshElement)));
      if (const std::string_view fault = checked.add(file.elements.back()); !fault.empty())
        in.bytes().fail(in.body_offset() + i * sizeof(MeshElement), std::string(fault),
                        "correct the program that wrote it");
    }
  const std::string end = in.read_end(kEndBodySize);
  if (!checked.complete())
    in.bytes().fail(in.body_offset(), "cells of the last triangle are missing", "correct the program that wrote it");
  if (get<std::uint64_t>(end.data()) != checked.count() || get<std::uint64_t>(end.data() + 8) != checked.photons())
    in.bytes().fail(in.body_offset(), "end block does not count the file's elements and photons");
  in.bytes().expect_end();
  return file;
}

std::string digest_of(const MeshirradFile& file) {
  Hasher elements;
  elements.add_bytes(file.elements.data(), file.elements.size() * sizeof(MeshElement));
  const bool is_frame = file.header.holds == MeshHolds::frame;
  const std::string holds = is_frame ? "" : "holds: " + std::string(kHolds[std::size_t(file.header.holds)]) + "\n";
  const std::string jump = file.header.jump ? "jump: yes\n" : "";
  return hash_hex("meshirrad: 1\n" + holds + jump + "origin: " + hex_of(file.header.origin) +
                  "\nunit: " + hex_of(std::span(&file.header.unit, 1)) +
                  "\nelements: " + std::to_string(file.elements.size()) + " #" + elements.hex() + "\n");
}

}  // namespace tempolux::formats
