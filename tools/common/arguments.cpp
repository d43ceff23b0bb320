#include "tools/common/arguments.h"

#include <algorithm>
#include <charconv>
#include <filesystem>
#include <limits>
#include <string_view>
#include <unordered_set>

#include "formats/error.h"
#include "lib/core/formatted.h"

namespace tempolux::tools {
namespace {

constexpr int kFrameLimit = 100'000'000;
constexpr std::size_t kMaxFrames = 1'000'000;

[[noreturn]] void bad(std::string_view text, const std::string& why) {
  throw InputError("'" + std::string(text) + "': " + why);
}

/// Reads an integer from the front of `rest`, and removes it.
int take_frame(std::string_view& rest, std::string_view whole) {
  int value = 0;
  const auto [end, error] = std::from_chars(rest.data(), rest.data() + rest.size(), value);
  if (error == std::errc::invalid_argument) bad(whole, "not a range of frames; write 12, 0-47, 0-47x2 or 1,5,9");
  if (error != std::errc{} || value < -kFrameLimit || value > kFrameLimit)
    bad(whole, "a frame number is outside +-10^8");
  rest.remove_prefix(std::size_t(end - rest.data()));
  return value;
}

void append_item(std::string_view item, std::string_view whole, std::vector<int>& frames) {
  std::string_view rest = item;
  const int first = take_frame(rest, whole);
  int last = first, step = 1;
  bool others = false;
  if (rest.starts_with('-')) {
    rest.remove_prefix(1);
    last = take_frame(rest, whole);
    if (rest.starts_with('x') || rest.starts_with('y')) {
      others = rest.front() == 'y';
      rest.remove_prefix(1);
      step = take_frame(rest, whole);
      if (step < 1) bad(whole, "the step must be at least 1");
    }
  }
  if (!rest.empty()) bad(whole, "not a range of frames; write 12, 0-47, 0-47x2 or 1,5,9");
  const int distance = last >= first ? last - first : first - last;
  const int count = others ? distance : distance / step;
  if (std::size_t(count) >= kMaxFrames * 2 || frames.size() + std::size_t(count) > kMaxFrames * 2)
    bad(whole, "more than 10^6 frames");
  for (int i = 0; i <= distance; i += others ? 1 : step) {
    if (!others || i % step != 0) frames.push_back(last >= first ? first + i : first - i);
    if (distance - i < step && !others) break;  // i + step could exceed the range of int
  }
}

/// The number field of a printf pattern that begins with the '%' at pattern[at]: where the field ends, and its least
/// width. end == at if there is no field.
struct Field {
  std::size_t end = 0;
  int width = 0;
  bool zeros = false;
};

Field field_at(const std::string& pattern, std::size_t at) {
  Field field{at, 0, false};
  std::size_t i = at + 1;
  if (i < pattern.size() && pattern[i] == '0') field.zeros = true, ++i;
  for (int digits = 0; i < pattern.size() && pattern[i] >= '0' && pattern[i] <= '9'; ++i, ++digits) {
    if (digits == 2) return field;
    field.width = field.width * 10 + (pattern[i] - '0');
  }
  if (i < pattern.size() && pattern[i] == 'd') field.end = i + 1;
  return field;
}

std::string digits_of(int frame, int width, bool zeros) { return formatted(zeros ? "%0*d" : "%*d", width, frame); }

/// Parses all of `text` as a number.
template <class Number>
bool parse_whole(std::string_view text, Number& value) {
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  return error == std::errc{} && end == text.data() + text.size();
}

/// Computes "12" or "1.5" times `factor` exactly; false if the result is not whole or reaches 2^63. At most 6 digits
/// after the point, so that their product with a factor of at most 2^40 fits.
bool scaled(std::string_view digits, std::uint64_t factor, std::uint64_t& value) {
  constexpr std::uint64_t kLimit = std::uint64_t{1} << 63;
  const std::size_t point = digits.find('.');
  std::uint64_t whole = 0, part = 0, power = 1;
  if (!parse_whole(digits.substr(0, point), whole) || whole > kLimit / factor) return false;
  if (point != std::string_view::npos) {
    const std::string_view after = digits.substr(point + 1);
    if (after.size() > 6 || !parse_whole(after, part)) return false;
    for (std::size_t i = 0; i < after.size(); ++i) power *= 10;
  }
  if (part * factor % power != 0) return false;
  value = whole * factor + part * factor / power;
  return value < kLimit;
}

std::size_t end_of_digits(const std::string& text) {
  return std::min(text.find_first_not_of("0123456789."), text.size());
}

}  // namespace

std::vector<int> parse_frames(const std::string& text) {
  std::vector<int> frames;
  std::string_view rest = text;
  while (true) {
    const std::size_t comma = rest.find(',');
    append_item(rest.substr(0, comma), text, frames);
    if (comma == std::string_view::npos) break;
    rest.remove_prefix(comma + 1);
  }
  std::unordered_set<int> seen;
  std::erase_if(frames, [&](int frame) { return !seen.insert(frame).second; });
  if (frames.empty()) bad(text, "no frame remains");
  if (frames.size() > kMaxFrames) bad(text, "more than 10^6 frames");
  return frames;
}

std::string frame_name(const std::string& pattern, int frame) {
  std::string name;
  for (std::size_t i = 0; i < pattern.size();) {
    if (pattern[i] == '#') {
      const std::size_t end = std::min(pattern.find_first_not_of('#', i), pattern.size());
      name += digits_of(frame, int(std::min<std::size_t>(end - i, 99)), true);
      i = end;
    } else if (pattern[i] == '%' && i + 1 < pattern.size() && pattern[i + 1] == '%') {
      name += '%';
      i += 2;
    } else if (pattern[i] == '%') {
      const Field field = field_at(pattern, i);
      if (field.end == i) bad(pattern, "'%' must begin a pattern such as %d or %04d, or be doubled");
      name += digits_of(frame, field.width, field.zeros);
      i = field.end;
    } else {
      name += pattern[i++];
    }
  }
  return name;
}

std::string name_with(const std::string& path, const std::string& ending) {
  const std::filesystem::path name(path);
  return (name.parent_path() / name.stem()).string() + ending + name.extension().string();
}

bool has_frame_pattern(const std::string& pattern) {
  for (std::size_t i = 0; i < pattern.size(); ++i) {
    if (pattern[i] == '#') return true;
    if (pattern[i] != '%') continue;
    if (field_at(pattern, i).end != i) return true;
    if (i + 1 < pattern.size() && pattern[i + 1] == '%') ++i;
  }
  return false;
}

std::uint64_t parse_count(const std::string& text) {
  const std::size_t digits = end_of_digits(text);
  const std::string suffix = text.substr(digits);
  const std::uint64_t factor = suffix.empty()                   ? 1
                               : suffix == "k" || suffix == "K" ? 1'000
                               : suffix == "M"                  ? 1'000'000
                               : suffix == "G"                  ? 1'000'000'000
                                                                : 0;
  std::uint64_t count = 0;
  if (factor == 0 || !scaled(std::string_view(text).substr(0, digits), factor, count))
    bad(text, "not a count; write a whole number such as 250000, 10k, 1.5M or 1G");
  return count;
}

std::string format_count(std::uint64_t count) {
  if (count != 0)
    for (const auto& [factor, suffix] : {std::pair{1'000'000'000u, "G"}, {1'000'000u, "M"}, {1'000u, "k"}})
      if (count % factor == 0) return std::to_string(count / factor) + suffix;
  return std::to_string(count);
}

std::uint64_t parse_bytes(const std::string& text) {
  const std::size_t digits = end_of_digits(text);
  const std::string suffix = text.substr(digits);
  int power = 0;
  if (!suffix.empty() && suffix != "B") {
    const std::size_t letter = std::string_view("KMGT").find(suffix.front() == 'k' ? 'K' : suffix.front());
    const std::string tail = suffix.substr(1);
    const bool known = letter != std::string_view::npos && (tail.empty() || tail == "B" || tail == "iB");
    power = known ? int(letter) + 1 : -1;
  }
  std::uint64_t bytes = 0;
  const std::string_view number = std::string_view(text).substr(0, digits);
  if (power < 0 || !scaled(number, std::uint64_t{1} << (10 * power), bytes))
    bad(text, "not a size; write bytes such as 500000, 64KiB, 300MiB or 2GiB");
  return bytes;
}

void parse_size(const std::string& text, int& width, int& height) {
  constexpr int kMaxSide = 65536;
  const auto number = [&](std::string_view part) {
    int value = 0;
    if (!parse_whole(part, value) || value < 1 || value > kMaxSide)
      bad(text, "not a size; write WIDTHxHEIGHT in pixels, each from 1 to 65536, such as 640x360");
    return value;
  };
  const std::size_t cross = text.find('x');
  if (cross == std::string::npos) number("");
  const int w = number(std::string_view(text).substr(0, cross));
  height = number(std::string_view(text).substr(cross + 1));
  width = w;
}

bool is_color(const std::string& text) { return text.find_first_not_of("0123456789.,e+-") == std::string::npos; }

std::array<float, 3> parse_color(const std::string& text) {
  std::array<float, 3> color{};
  std::string_view rest = text;
  for (std::size_t channel = 0; channel < 3; ++channel) {
    const std::string_view part = rest.substr(0, rest.find(','));
    if (!parse_whole(part, color[channel]) || !(color[channel] >= 0 && color[channel] <= 1e30f))
      bad(text, "not a colour; write R,G,B, three numbers from 0 on, such as 0.2,0.3,0.5, or one for grey");
    if (channel == 0 && part.size() == rest.size()) return {color[0], color[0], color[0]};
    rest.remove_prefix(std::min(rest.size(), part.size() + 1));
  }
  if (!rest.empty() || text.back() == ',') bad(text, "not a colour; write R,G,B, such as 0.2,0.3,0.5");
  return color;
}

}  // namespace tempolux::tools
