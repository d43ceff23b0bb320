// formats/photons/header.cpp -- writes and parses the text of a header (photons.md, section 2).
#include <algorithm>

#include "formats/base_file.h"
#include "formats/photons/layout.h"

namespace tempolux::formats::photons {
namespace {

constexpr std::array<std::string_view, kPathKinds> kKindNames{"direct", "caustic", "indirect", "volume", "tentative"};
constexpr std::array<std::string_view, 4> kColumnsNames{"none", "direction", "albedo", "direction,albedo"};

/// Bit set of the kinds in a list such as "direct,caustic"; 0 if the text is no such list.
std::uint32_t parse_kinds(std::string_view list) {
  std::uint32_t kinds = 0;
  for (std::size_t first = 0; first <= list.size();) {
    const std::size_t last = std::min(list.find(',', first), list.size());
    const auto name = std::find(kKindNames.begin(), kKindNames.end(), list.substr(first, last - first));
    const std::uint32_t bit = name == kKindNames.end() ? 0 : 1u << (name - kKindNames.begin());
    if (bit == 0 || (kinds & bit)) return 0;
    kinds |= bit;
    first = last + 1;
  }
  return kinds;
}

constexpr std::uint32_t kTentative = 1u << int(PathKind::tentative);

/// Checks the values for both reader and writer: returns the fault, or "" if there is none.
std::string_view fault_of(const PhotonHeader& h) {
  if (h.map != "global" && h.map != "static" && h.map != "dynamic") return "map is not global, static or dynamic";
  if (parse_kinds(h.kinds) == 0) return "kinds is not a list of direct, caustic, indirect, volume, tentative";
  if (!is_part(h.part)) return "part is not low or high";
  if ((parse_kinds(h.kinds) & kTentative) != 0 && h.majorants.empty())
    return "kinds has tentative, but majorants is missing";
  if ((parse_kinds(h.kinds) & kTentative) == 0 && !h.majorants.empty()) return "majorants, but kinds has no tentative";
  if (!h.majorants.empty() && !is_digest(h.majorants)) return "majorants is not 32 hexadecimal digits";
  if (h.pilots > kMostPilots) return "pilots is not in 1 .. 256";
  if (h.pilots > 0 && h.majorants.empty()) return "pilots, but kinds has no tentative";
  if (h.columns >= kColumnsNames.size()) return "columns are not known";
  if (h.group_count < 1 || h.group_count > kMaxGroupCount) return "groups is not in 1 .. 16777216";
  if (const std::string_view fault = fault_of_common(h.origin, h.identity); !fault.empty()) return fault;
  return fault_of_base(h.base_name, h.base_digest);
}

constexpr std::uint16_t kEmissionSince = 1, kPartSince = 2, kTentativeSince = 3, kPilotsSince = 4;  ///< minor versions

/// Parses the value of one line and stores it in the header.
Line take_line(std::string_view key, std::string_view value, std::uint16_t minor, PhotonHeader& h) {
  const auto result = [](bool good) { return good ? Line::good : Line::bad_value; };
  if (key == "map") return h.map = value, Line::good;
  if (key == "kinds") return h.kinds = value, Line::good;
  if (key == "columns") {
    h.columns = std::uint32_t(std::find(kColumnsNames.begin(), kColumnsNames.end(), value) - kColumnsNames.begin());
    return Line::good;
  }
  if (key == "part" && minor >= kPartSince) return h.part = value, result(!value.empty());
  if (key == "groups") return result(parse_numbers(value, &h.group_count, 1));
  if (key == "emitted") return result(parse_numbers(value, &h.emitted_count, 1));
  if (key == "emission" && minor >= kEmissionSince) return h.identity.emission = value, result(!value.empty());
  if (key == "majorants" && minor >= kTentativeSince) return h.majorants = value, result(!value.empty());
  if (key == "pilots" && minor >= kPilotsSince) return result(parse_numbers(value, &h.pilots, 1) && h.pilots > 0);
  if (key == "base") return h.base_name = value, result(!value.empty());
  if (key == "base-digest") return h.base_digest = value, result(!value.empty());
  return take_common_line(key, value, common_keys(h));
}

}  // namespace

bool has_tentative(const PhotonHeader& h) { return (parse_kinds(h.kinds) & kTentative) != 0; }

std::string_view ledger_mark(const PhotonHeader& h) {
  return h.pilots > 0 ? kPilotLedgerMark : has_tentative(h) ? kDatedLedgerMark : kLedgerMark;
}

std::size_t ledger_entry_size(const PhotonHeader& h) {
  return has_tentative(h) ? kDatedLedgerEntrySize + h.pilots * sizeof(PhotonPilot) : kLedgerEntrySize;
}

Format format_of(const PhotonHeader& h) {
  Format format = kFormat;
  format.minor = h.pilots > 0                   ? kPilotsSince
                 : has_tentative(h)             ? kTentativeSince
                 : !h.part.empty()              ? kPartSince
                 : !h.identity.emission.empty() ? kEmissionSince
                                                : 0;
  return format;
}

std::string header_text(const PhotonHeader& h) {
  HeaderText text("photons");
  if (const std::string_view fault = fault_of(h); !fault.empty()) text.refuse(fault);
  text.line("map", h.map);
  text.line("kinds", h.kinds);
  if (!h.part.empty()) text.line("part", h.part);
  text.line("columns", kColumnsNames[h.columns]);
  text.origin(h.origin);
  text.line("groups", text_of(h.group_count));
  text.line("emitted", text_of(h.emitted_count));
  text.identity(h.identity);
  if (!h.identity.emission.empty()) text.line("emission", h.identity.emission);
  if (!h.majorants.empty()) text.line("majorants", h.majorants);
  if (h.pilots > 0) text.line("pilots", text_of(h.pilots));
  if (!h.base_name.empty()) {
    text.line("base", h.base_name);
    text.line("base-digest", h.base_digest);
  }
  text.history(h.history);
  return text.finish();
}

std::optional<HeaderError> parse_header_text(std::string_view text, std::uint16_t minor, PhotonHeader& h) {
  h = PhotonHeader();
  constexpr std::array<std::string_view, 6> required{"map", "kinds", "columns", "origin", "groups", "emitted"};
  auto error = parse_lines(text, minor > kFormat.minor, required, [&](std::string_view key, std::string_view value) {
    return take_line(key, value, minor, h);
  });
  if (error) return error;
  if (const std::string_view fault = fault_of(h); !fault.empty())
    return HeaderError{0, "header: " + std::string(fault)};
  if (minor < kTentativeSince && has_tentative(h))
    return HeaderError{0, "header: kinds has tentative, which is since version 1.3"};
  return std::nullopt;
}

RecordRules rules_of(const PhotonHeader& header) { return {parse_kinds(header.kinds), header.map == "dynamic"}; }

}  // namespace tempolux::formats::photons
