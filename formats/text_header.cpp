#include "formats/text_header.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <vector>

namespace tempolux::formats {
namespace {

/// The concern's key in a header line: its name with - instead of _.
std::string key_of(const Concern& concern) {
  std::string key(concern.name);
  std::replace(key.begin(), key.end(), '_', '-');
  return key;
}

bool is_control(char c) { return static_cast<unsigned char>(c) < 0x20 || c == 0x7f; }

bool is_hash(std::string_view text) {
  return text.size() <= 128 && !text.empty() &&
         std::all_of(text.begin(), text.end(), [](char c) { return c > 0x20 && c < 0x7f; });
}

}  // namespace

bool is_printable(std::string_view text) { return std::none_of(text.begin(), text.end(), is_control); }

bool is_part(std::string_view text) { return text.empty() || text == "low" || text == "high"; }

std::string_view fault_of_common(const std::array<double, 3>& origin, const Identity& identity) {
  for (double x : origin)
    if (!std::isfinite(x)) return "origin is not finite";
  for (const Concern& concern : kConcerns) {
    const std::string& hash = identity.*concern.hash;
    if (!hash.empty() && !is_hash(hash)) return "an identity hash is not 1 to 128 visible ASCII characters";
    if (!hash.empty() && !identity.known()) return "identity hashes without frames";
  }
  return "";
}

Line take_common_line(std::string_view key, std::string_view value, const CommonKeys& keys) {
  const auto result = [](bool good) { return good ? Line::good : Line::bad_value; };
  if (key == "origin") return result(parse_numbers(value, keys.origin.data(), 3));
  if (key == "frames") {
    std::array<std::int32_t, 2> frames{};
    if (!parse_numbers(value, frames.data(), 2) || frames[1] < frames[0]) return Line::bad_value;
    keys.identity.first_frame = frames[0];
    keys.identity.last_frame = frames[1];
    return Line::good;
  }
  for (const Concern& concern : kSceneConcerns)
    if (key == key_of(concern)) return keys.identity.*concern.hash = value, result(!value.empty());
  if (key == "history") return keys.history.append(value).append("\n"), Line::good;
  return Line::unknown_key;
}

std::optional<HeaderError> parse_lines(std::string_view text, bool allow_unknown,
                                       std::span<const std::string_view> required,
                                       const std::function<Line(std::string_view, std::string_view)>& take) {
  std::vector<std::string_view> seen;
  const auto is_seen = [&](std::string_view key) { return std::find(seen.begin(), seen.end(), key) != seen.end(); };
  for (std::size_t first = 0; first < text.size();) {
    const std::size_t last = text.find('\n', first);
    if (last == text.npos) return HeaderError{first, "header line without LF"};
    const std::string_view line = text.substr(first, last - first);
    const std::size_t colon = line.find(": ");
    if (colon == line.npos || !is_printable(line)) return HeaderError{first, "header line is not \"key: value\""};
    const std::string_view key = line.substr(0, colon);
    if (key != "history" && is_seen(key)) return HeaderError{first, "header key twice: " + std::string(key)};
    const Line result = take(key, line.substr(colon + 2));
    if (result == Line::bad_value) return HeaderError{first, "bad value of header key " + std::string(key)};
    if (result == Line::unknown_key && !allow_unknown)
      return HeaderError{first, "unknown header key " + std::string(key)};
    if (result == Line::good && key != "history") seen.push_back(key);
    first = last + 1;
  }
  for (std::string_view key : required)
    if (!is_seen(key)) return HeaderError{0, "header key missing: " + std::string(key)};
  return std::nullopt;
}

void HeaderText::refuse(std::string_view reason) const {
  throw std::invalid_argument(format_ + " header: " + std::string(reason));
}

void HeaderText::line(std::string_view key, std::string_view value) {
  text_.append(key).append(": ").append(value).append("\n");
  if (!is_printable(value)) refuse("a control character in a value");
}

void HeaderText::origin(const std::array<double, 3>& origin) {
  line("origin", text_of(origin[0]) + " " + text_of(origin[1]) + " " + text_of(origin[2]));
}

void HeaderText::identity(const Identity& identity) {
  if (!identity.known()) return;
  line("frames", text_of(identity.first_frame) + " " + text_of(identity.last_frame));
  for (const Concern& concern : kSceneConcerns)
    if (!(identity.*concern.hash).empty()) line(key_of(concern), identity.*concern.hash);
}

void HeaderText::history(std::string_view history) {
  if (!history.empty() && history.back() != '\n') refuse("the history does not end in LF");
  for (std::size_t first = 0; first < history.size();) {
    const std::size_t last = history.find('\n', first);
    line("history", history.substr(first, last - first));
    first = last + 1;
  }
}

std::string HeaderText::finish() const {
  if (text_.size() > kMaxTextSize) refuse("text larger than 2^20 bytes");
  return text_;
}

}  // namespace tempolux::formats
