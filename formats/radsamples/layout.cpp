#include "formats/radsamples/layout.h"

#include <cmath>
#include <limits>
#include <span>

#include "formats/base_file.h"
#include "formats/float_bits.h"

namespace tempolux::formats::radsamples {
namespace {

/// Checks the values for both reader and writer: returns the fault, or "" if there is none.
std::string_view fault_of(const RadsamplesHeader& h) {
  if (!std::isfinite(h.diagonal) || h.diagonal <= 0) return "diagonal is not a length above 0";
  if (h.segment[0] > h.segment[1]) return "segment ends before it begins";
  if (h.anchors == h.points_hash.empty()) return "points go with the column anchor";
  if (h.high_hash.size() > 128 || h.high_hash.find(' ') != h.high_hash.npos) return "high is not a hash";
  if (const std::string_view fault = fault_of_base(h.base_name, h.base_digest); !fault.empty()) return fault;
  return fault_of_common(h.origin, h.identity);
}

Line take_line(std::string_view key, std::string_view value, std::uint16_t minor, RadsamplesHeader& h) {
  const auto result = [](bool good) { return good ? Line::good : Line::bad_value; };
  if (key == "columns") return h.anchors = value == "anchor", result(h.anchors || value == "none");
  if (key == "diagonal") return result(parse_numbers(value, &h.diagonal, 1));
  if (key == "segment") return result(parse_numbers(value, h.segment.data(), 2));
  if (key == "points") {
    h.points_hash = value;
    return result(!value.empty() && value.size() <= 128 && value.find(' ') == value.npos);
  }
  if (minor >= kHighSince && key == "high") return h.high_hash = value, result(!value.empty());
  if (minor >= kBaseSince && key == "base") return h.base_name = value, result(!value.empty());
  if (minor >= kBaseSince && key == "base-digest") return h.base_digest = value, result(!value.empty());
  return take_common_line(key, value, common_keys(h));
}

bool is_share(float x) { return is_finite(x) && x >= 0; }
bool is_length(float x) { return is_finite(x) && x > 0; }
constexpr float kInfinity = std::numeric_limits<float>::infinity();

}  // namespace

std::string header_text(const RadsamplesHeader& h) {
  HeaderText text("radsamples");
  if (const std::string_view fault = fault_of(h); !fault.empty()) text.refuse(fault);
  text.line("columns", h.anchors ? "anchor" : "none");
  text.origin(h.origin);
  text.line("diagonal", text_of(h.diagonal));
  text.line("segment", text_of(h.segment[0]) + " " + text_of(h.segment[1]));
  if (h.anchors) text.line("points", h.points_hash);
  if (!h.high_hash.empty()) text.line("high", h.high_hash);
  if (!h.base_name.empty()) {
    text.line("base", h.base_name);
    text.line("base-digest", h.base_digest);
  }
  text.identity(h.identity);
  text.history(h.history);
  return text.finish();
}

std::optional<HeaderError> parse_header_text(std::string_view text, std::uint16_t minor, bool allow_unknown,
                                             RadsamplesHeader& h) {
  h = RadsamplesHeader();
  constexpr std::array<std::string_view, 4> required{"columns", "origin", "diagonal", "segment"};
  const auto take = [&](std::string_view key, std::string_view value) { return take_line(key, value, minor, h); };
  if (auto error = parse_lines(text, allow_unknown, required, take)) return error;
  if (const std::string_view fault = fault_of(h); !fault.empty())
    return HeaderError{0, "header: " + std::string(fault)};
  return std::nullopt;
}

std::string_view fault_of(const RadsamplesRecord& r) {
  double square = 0;
  for (float x : r.normal) square += double(x) * double(x);
  if (!is_finite(r.position)) return "position is not finite";
  if (!is_finite(r.normal) || !(std::abs(square - 1) <= 2e-4)) return "normal is not of length 1";
  if (!is_share(r.barycentric[0]) || !is_share(r.barycentric[1]) || r.barycentric[0] + r.barycentric[1] > 1.0001f)
    return "place is not in its triangle";
  if (r.rings < 1 || r.sectors < 3) return "there are no cells";
  if (static_cast<unsigned>(r.set) > 1) return "set is neither 0 nor 1";
  if (r.fading > 3) return "fading is above 3";
  if (!is_share(r.footprint) || !is_share(r.expected_share) || !is_share(r.lit_share) || !is_share(r.further_share) ||
      !is_share(r.birth_weight))
    return "a share, a weight or the footprint is not finite or is negative";
  if (!is_length(r.radius)) return "radius is not a length above 0";
  if (r.radius_unclamped != kInfinity && !is_share(r.radius_unclamped))
    return "unclamped radius is not a number or is negative";
  if (!is_finite(r.irradiance) || is_negative(r.irradiance)) return "irradiance is not finite or is negative";
  for (std::size_t c = 0; c < 3; ++c)
    if (!is_finite(r.rotational[c]) || !is_finite(r.translational[c])) return "a gradient is not finite";
  if (!(r.clearance_reach > 0)) return "clearance does not reach anywhere";
  return "";
}

std::string_view fault_of(const RadianceSample& s, std::uint32_t anchor, std::size_t points) {
  if (age_of(s) == 0) return "age is 0";
  if (!(s.flags & sample_valid)) {
    const bool dark = s.rgbe == std::array<std::uint8_t, 4>{} && s.distance == 0;
    return s.flags <= kMaxAge && dark && anchor == kNoAnchor ? "" : "an invalid sample holds something";
  }
  if ((s.distance & 0x8000) || (s.distance & 0x7c00) == 0x7c00) return "distance is negative or not finite";
  if (s.flags & sample_miss) {
    if (s.distance != 0 || s.flags & (sample_dynamic | sample_near | sample_anchored)) return "a miss met something";
  } else if (s.distance < 0x0400) {
    return "distance is below 2^-14";
  }
  if (bool(s.flags & sample_anchored) != (anchor != kNoAnchor)) return "anchor and flags differ";
  if (anchor != kNoAnchor && anchor >= points) return "anchor is none of the points";
  return "";
}

bool is_own(const RadsamplesFile& file, std::size_t record) {
  return file.kept_from.empty() || file.kept_from[record] == 0;
}
std::uint64_t own_samples(const RadsamplesFile& file) {
  std::uint64_t count = 0;
  for (std::size_t i = 0; i < file.records.size(); ++i)
    if (is_own(file, i)) count += file.records[i].samples();
  return count;
}

Totals totals_of(const RadsamplesFile& file) {
  ExactRgbSum sum;
  for (const RadsamplesRecord& record : file.records) sum.add(record.irradiance);
  return {file.point_light.size(), file.records.size(), own_samples(file), sum.rounded()};
}

}  // namespace tempolux::formats::radsamples
