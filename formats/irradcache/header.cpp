// formats/irradcache/header.cpp -- writes and parses the text of a header (irradcache.md, section 1).
#include <algorithm>
#include <cmath>

#include "formats/irradcache/layout.h"

namespace tempolux::formats::irradcache {
namespace {

constexpr std::uint16_t kLeastCosineSince = 1, kClearanceSince = 2, kNoiseSince = 3,
                        kLampsApartSince = 4;  ///< minor versions

constexpr std::array<std::string_view, 5> kColumnNames{"influence", "update", "clearance", "noise", "apart"};
constexpr std::uint32_t kApart = 1u << 4;  ///< a column without bytes: `lamps-apart` is there
constexpr std::uint32_t kColumnSets = 1u << kColumnNames.size();

/// Value of the key `columns`.
std::string names_of(std::uint32_t columns) {
  std::string names;
  for (std::size_t i = 0; i < kColumnNames.size(); ++i)
    if (columns >> i & 1) names += (names.empty() ? "" : ",") + std::string(kColumnNames[i]);
  return names.empty() ? "none" : names;
}

/// Checks the values for both reader and writer: returns the fault, or "" if there is none.
std::string_view fault_of(const IrradcacheHeader& h) {
  if (h.columns >= kApart) return "columns are not known";
  if (!std::isfinite(h.error_bound) || h.error_bound < 0) return "error-bound is not finite or is negative";
  if (!(h.least_cosine >= 0 && h.least_cosine < 1)) return "least-cosine is not from 0 to below 1";
  if (!std::isfinite(h.lamps_apart) || h.lamps_apart < 0) return "lamps-apart is not finite or is negative";
  if (!std::isfinite(h.max_radius) || !(h.min_radius >= 0 && h.min_radius <= h.max_radius))
    return "radii are not two lengths, the smaller first";
  for (std::size_t i = 0; i < h.placed_frames.size(); ++i) {
    const auto [first, last] = h.placed_frames[i];
    if (first > last || (i > 0 && std::int64_t(first) <= std::int64_t(h.placed_frames[i - 1][1]) + 1))
      return "placed is not a list of ranges that ascend and lie apart";
  }
  return fault_of_common(h.origin, h.identity);
}

/// Parses "first last first last ..."; false if the text has another form.
bool parse_ranges(std::string_view text, std::vector<std::array<std::int32_t, 2>>& ranges) {
  const auto spaces = std::size_t(std::count(text.begin(), text.end(), ' '));
  if (spaces % 2 == 0) return false;
  std::vector<std::int32_t> numbers(spaces + 1);
  if (!parse_numbers(text, numbers.data(), numbers.size())) return false;
  for (std::size_t i = 0; i < numbers.size(); i += 2) ranges.push_back({numbers[i], numbers[i + 1]});
  return true;
}

Line take_line(std::string_view key, std::string_view value, std::uint16_t minor, IrradcacheHeader& h) {
  const auto result = [](bool good) { return good ? Line::good : Line::bad_value; };
  if (key == "columns") {
    h.columns = 0;
    while (h.columns < kColumnSets && names_of(h.columns) != value) ++h.columns;
    return result(h.columns < kColumnSets && !(h.columns & column_clearance && minor < kClearanceSince) &&
                  !(h.columns & column_noise && minor < kNoiseSince) &&
                  !(h.columns & kApart && minor < kLampsApartSince));
  }
  if (key == "rays") return result(parse_numbers(value, &h.rays, 1) && h.rays > 0);
  if (key == "error-bound") return result(parse_numbers(value, &h.error_bound, 1) && h.error_bound > 0);
  if (key == "least-cosine" && minor >= kLeastCosineSince) return result(parse_numbers(value, &h.least_cosine, 1));
  if (key == "lamps-apart" && minor >= kLampsApartSince)
    return result(parse_numbers(value, &h.lamps_apart, 1) && h.lamps_apart > 0);
  if (key == "radii") {
    std::array<double, 2> radii{};
    if (!parse_numbers(value, radii.data(), 2) || !(radii[1] > 0)) return Line::bad_value;
    h.min_radius = radii[0];
    h.max_radius = radii[1];
    return Line::good;
  }
  if (key == "placed") return result(parse_ranges(value, h.placed_frames));
  return take_common_line(key, value, common_keys(h));
}

std::string ranges_text(const std::vector<std::array<std::int32_t, 2>>& ranges) {
  std::string text;
  for (const auto& [first, last] : ranges)
    text.append(text.empty() ? "" : " ").append(text_of(first)).append(" ").append(text_of(last));
  return text;
}

bool has_least_cosine(const IrradcacheHeader& h) { return h.least_cosine != kLeastCosine; }

}  // namespace

Format format_of(const IrradcacheHeader& h) {
  Format format = kFormat;
  format.minor = h.lamps_apart > 0              ? kLampsApartSince
                 : h.columns & column_noise     ? kNoiseSince
                 : h.columns & column_clearance ? kClearanceSince
                 : has_least_cosine(h)          ? kLeastCosineSince
                                                : 0;
  return format;
}

std::string header_text(const IrradcacheHeader& h) {
  HeaderText text("irradcache");
  if (const std::string_view fault = fault_of(h); !fault.empty()) text.refuse(fault);
  text.line("columns", names_of(h.columns | (h.lamps_apart > 0 ? kApart : 0)));
  text.origin(h.origin);
  if (h.rays > 0) text.line("rays", text_of(h.rays));
  if (h.error_bound > 0) text.line("error-bound", text_of(h.error_bound));
  if (has_least_cosine(h)) text.line("least-cosine", text_of(h.least_cosine));
  if (h.lamps_apart > 0) text.line("lamps-apart", text_of(h.lamps_apart));
  if (h.max_radius > 0) text.line("radii", text_of(h.min_radius) + " " + text_of(h.max_radius));
  if (!h.placed_frames.empty()) text.line("placed", ranges_text(h.placed_frames));
  text.identity(h.identity);
  text.history(h.history);
  return text.finish();
}

std::optional<HeaderError> parse_header_text(std::string_view text, std::uint16_t minor, IrradcacheHeader& h) {
  h = IrradcacheHeader();
  constexpr std::array<std::string_view, 2> required{"columns", "origin"};
  const auto take = [&](std::string_view key, std::string_view value) { return take_line(key, value, minor, h); };
  if (auto error = parse_lines(text, minor > kFormat.minor, required, take)) return error;
  if (bool(h.columns & kApart) != (h.lamps_apart > 0))
    return HeaderError{0, "header: the column apart and lamps-apart do not come together"};
  h.columns &= ~kApart;
  if (const std::string_view fault = fault_of(h); !fault.empty())
    return HeaderError{0, "header: " + std::string(fault)};
  return std::nullopt;
}

}  // namespace tempolux::formats::irradcache
