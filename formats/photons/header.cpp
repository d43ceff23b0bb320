// formats/photons/header.cpp -- the text of a header (photons.md, section 2).
#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstring>
#include <limits>
#include <stdexcept>

#include "formats/photons/layout.h"

namespace tempolux::formats::photons {
namespace {

constexpr std::array<std::string_view, 4> kKindNames{"direct", "caustic", "indirect", "volume"};
constexpr std::array<std::string_view, 4> kColumnsNames{"none", "direction", "albedo", "direction,albedo"};

struct HashKey {
  std::string_view key;
  std::string Identity::* hash;
};
constexpr std::array<HashKey, 5> kHashKeys{{{"static-geometry", &Identity::static_geometry},
                                            {"moving-geometry", &Identity::moving_geometry},
                                            {"materials", &Identity::materials},
                                            {"lights", &Identity::lights},
                                            {"media", &Identity::media}}};

/// Bit set of the kinds in a list "direct,caustic"; 0 if it is not one.
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

template <class T>
std::string text_of(T number) {
  std::array<char, 32> text;
  return {text.data(), std::to_chars(text.data(), text.data() + text.size(), number).ptr};
}

/// `count` numbers parted by one space; false if the text is anything else.
template <class T>
bool parse_numbers(std::string_view text, T* numbers, std::size_t count) {
  const char *p = text.data(), *end = text.data() + text.size();
  for (std::size_t i = 0; i < count; ++i) {
    if (i > 0 && (p == end || *p++ != ' ')) return false;
    const auto [next, error] = std::from_chars(p, end, numbers[i]);
    if (error != std::errc()) return false;
    p = next;
  }
  return p == end;
}

bool is_control(char c) { return static_cast<unsigned char>(c) < 0x20 || c == 0x7f; }
bool is_printable(std::string_view text) { return std::none_of(text.begin(), text.end(), is_control); }
bool is_hash(std::string_view text) {
  return text.size() <= 128 && !text.empty() &&
         std::all_of(text.begin(), text.end(), [](char c) { return c > 0x20 && c < 0x7f; });
}
bool is_digest(std::string_view text) {
  return text.size() == 32 && text.find_first_not_of("0123456789abcdef") == text.npos;
}
bool is_base_name(std::string_view text) {
  return !text.empty() && text != "." && text != ".." && text.find('/') == text.npos && is_printable(text);
}

/// What is wrong with the values, as the reader and the writer both see it; "" if nothing.
std::string_view fault_of(const PhotonHeader& h) {
  if (h.map != "global" && h.map != "static" && h.map != "dynamic")
    return "map is not global, static or dynamic";
  if (parse_kinds(h.kinds) == 0) return "kinds is not a list of direct, caustic, indirect, volume";
  if (h.columns >= kColumnsNames.size()) return "columns are not known";
  for (double x : h.origin)
    if (!std::isfinite(x)) return "origin is not finite";
  if (h.group_count < 1 || h.group_count > kMaxGroupCount) return "groups is not in 1 .. 16777216";
  for (const HashKey& key : kHashKeys) {
    const std::string& hash = h.identity.*key.hash;
    if (!hash.empty() && !is_hash(hash)) return "an identity hash is not 1 to 128 visible ASCII characters";
    if (!hash.empty() && !h.identity.known()) return "identity hashes without frames";
  }
  if (h.base_name.empty() != h.base_digest.empty()) return "base and base-digest do not stand together";
  if (!h.base_name.empty() && !is_base_name(h.base_name))
    return "base is not the name of a file without folder";
  if (!h.base_name.empty() && !is_digest(h.base_digest)) return "base-digest is not 32 hexadecimal digits";
  return "";
}

enum class Line { good, bad_value, unknown_key };

/// Takes one line's value into the header.
Line take_line(std::string_view key, std::string_view value, PhotonHeader& h) {
  const auto result = [](bool good) { return good ? Line::good : Line::bad_value; };
  if (key == "map") return h.map = value, Line::good;
  if (key == "kinds") return h.kinds = value, Line::good;
  if (key == "columns") {
    h.columns =
        std::uint32_t(std::find(kColumnsNames.begin(), kColumnsNames.end(), value) - kColumnsNames.begin());
    return Line::good;
  }
  if (key == "origin") return result(parse_numbers(value, h.origin.data(), 3));
  if (key == "groups") return result(parse_numbers(value, &h.group_count, 1));
  if (key == "emitted") return result(parse_numbers(value, &h.emitted_count, 1));
  if (key == "frames") {
    std::array<std::int32_t, 2> frames{};
    if (!parse_numbers(value, frames.data(), 2) || frames[1] < frames[0]) return Line::bad_value;
    h.identity.first_frame = frames[0];
    h.identity.last_frame = frames[1];
    return Line::good;
  }
  for (const HashKey& hash : kHashKeys)
    if (key == hash.key) return h.identity.*hash.hash = value, result(!value.empty());
  if (key == "base") return h.base_name = value, result(!value.empty());
  if (key == "base-digest") return h.base_digest = value, result(!value.empty());
  if (key == "history") return h.history.append(value).append("\n"), Line::good;
  return Line::unknown_key;
}

void append_line(std::string& text, std::string_view key, std::string_view value) {
  text.append(key).append(": ").append(value).append("\n");
}

}  // namespace

std::string header_text(const PhotonHeader& h) {
  if (const std::string_view fault = fault_of(h); !fault.empty())
    throw std::invalid_argument("photons header: " + std::string(fault));
  std::string text;
  append_line(text, "map", h.map);
  append_line(text, "kinds", h.kinds);
  append_line(text, "columns", kColumnsNames[h.columns]);
  append_line(text, "origin", text_of(h.origin[0]) + " " + text_of(h.origin[1]) + " " + text_of(h.origin[2]));
  append_line(text, "groups", text_of(h.group_count));
  append_line(text, "emitted", text_of(h.emitted_count));
  if (h.identity.known()) {
    append_line(text, "frames", text_of(h.identity.first_frame) + " " + text_of(h.identity.last_frame));
    for (const HashKey& hash : kHashKeys)
      if (!(h.identity.*hash.hash).empty()) append_line(text, hash.key, h.identity.*hash.hash);
  }
  if (!h.base_name.empty()) {
    append_line(text, "base", h.base_name);
    append_line(text, "base-digest", h.base_digest);
  }
  if (!h.history.empty() && h.history.back() != '\n')
    throw std::invalid_argument("photons header: the history does not end in LF");
  for (std::size_t first = 0; first < h.history.size();) {
    const std::size_t last = h.history.find('\n', first);
    append_line(text, "history", std::string_view(h.history).substr(first, last - first));
    first = last + 1;
  }
  if (std::any_of(text.begin(), text.end(), [](char c) { return c != '\n' && is_control(c); }))
    throw std::invalid_argument("photons header: a control character in a value");
  if (text.size() > kMaxTextSize) throw std::invalid_argument("photons header: text larger than 2^20 bytes");
  return text;
}

std::optional<HeaderError> parse_header_text(std::string_view text, bool allow_unknown, PhotonHeader& h) {
  h = PhotonHeader();
  std::vector<std::string_view> seen;
  for (std::size_t first = 0; first < text.size();) {
    const std::size_t last = text.find('\n', first);
    if (last == text.npos) return HeaderError{first, "header line without LF"};
    const std::string_view line = text.substr(first, last - first);
    const std::size_t colon = line.find(": ");
    if (colon == line.npos || !is_printable(line))
      return HeaderError{first, "header line is not \"key: value\""};
    const std::string_view key = line.substr(0, colon);
    if (key != "history" && std::find(seen.begin(), seen.end(), key) != seen.end())
      return HeaderError{first, "header key twice: " + std::string(key)};
    const Line result = take_line(key, line.substr(colon + 2), h);
    if (result == Line::bad_value) return HeaderError{first, "bad value of header key " + std::string(key)};
    if (result == Line::unknown_key && !allow_unknown)
      return HeaderError{first, "unknown header key " + std::string(key)};
    if (result == Line::good && key != "history") seen.push_back(key);
    first = last + 1;
  }
  for (std::string_view key : {"map", "kinds", "columns", "origin", "groups", "emitted"})
    if (std::find(seen.begin(), seen.end(), key) == seen.end())
      return HeaderError{0, "header key missing: " + std::string(key)};
  if (const std::string_view fault = fault_of(h); !fault.empty())
    return HeaderError{0, "header: " + std::string(fault)};
  return std::nullopt;
}

RecordRules rules_of(const PhotonHeader& header) {
  return {parse_kinds(header.kinds), header.map == "dynamic"};
}

}  // namespace tempolux::formats::photons
