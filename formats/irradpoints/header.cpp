// formats/irradpoints/header.cpp -- writes and parses the text of a header (irradpoints.md, section 1).
#include <algorithm>
#include <cmath>

#include "formats/irradpoints/layout.h"

namespace tempolux::formats::irradpoints {
namespace {

/// Checks the values for both reader and writer: returns the fault, or "" if there is none.
std::string_view fault_of(const IrradpointsHeader& h) {
  if (kinds_of(h.kinds) == 0) return "kinds is not a list of direct, caustic, indirect in this order";
  if (h.columns > column_points_noise) return "columns are not known";
  if (!is_part(h.part)) return "part is not low or high";
  if (!std::isfinite(h.spacing) || h.spacing <= 0) return "spacing is not a length above 0";
  return fault_of_common(h.origin, h.identity);
}

constexpr std::uint16_t kPartSince = 1, kNoiseSince = 2;  ///< minor versions

Line take_line(std::string_view key, std::string_view value, std::uint16_t minor, IrradpointsHeader& h) {
  const auto result = [](bool good) { return good ? Line::good : Line::bad_value; };
  if (key == "kinds") return h.kinds = value, Line::good;
  if (key == "columns" && minor >= kNoiseSince) return h.columns = column_points_noise, result(value == "noise");
  if (key == "part" && minor >= kPartSince) return h.part = value, result(!value.empty());
  if (key == "spacing") return result(parse_numbers(value, &h.spacing, 1));
  if (key == "emitted") return result(parse_numbers(value, &h.emitted_count, 1));
  return take_common_line(key, value, common_keys(h));
}

}  // namespace

unsigned kinds_of(std::string_view list) {
  for (unsigned kinds = 1; kinds < 8; ++kinds) {
    std::string names;
    for (std::size_t k = 0; k < kKinds.size(); ++k)
      if ((kinds >> k) & 1) names.append(names.empty() ? "" : ",").append(kKinds[k].name);
    if (names == list) return kinds;
  }
  return 0;
}

Format format_of(const IrradpointsHeader& h) {
  Format format = kFormat;
  format.minor = h.columns ? kNoiseSince : h.part.empty() ? 0 : kPartSince;
  return format;
}

std::string header_text(const IrradpointsHeader& h) {
  HeaderText text("irradpoints");
  if (const std::string_view fault = fault_of(h); !fault.empty()) text.refuse(fault);
  text.line("kinds", h.kinds);
  if (h.columns) text.line("columns", "noise");
  if (!h.part.empty()) text.line("part", h.part);
  text.origin(h.origin);
  text.line("spacing", text_of(h.spacing));
  text.line("emitted", text_of(h.emitted_count));
  text.identity(h.identity);
  text.history(h.history);
  return text.finish();
}

std::optional<HeaderError> parse_header_text(std::string_view text, std::uint16_t minor, IrradpointsHeader& h) {
  h = IrradpointsHeader();
  constexpr std::array<std::string_view, 4> required{"kinds", "origin", "spacing", "emitted"};
  const auto take = [&](std::string_view key, std::string_view value) { return take_line(key, value, minor, h); };
  if (auto error = parse_lines(text, minor > kFormat.minor, required, take)) return error;
  if (const std::string_view fault = fault_of(h); !fault.empty())
    return HeaderError{0, "header: " + std::string(fault)};
  return std::nullopt;
}

}  // namespace tempolux::formats::irradpoints
