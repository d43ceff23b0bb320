// formats/text_header.h -- the text of a container's header: lines "key: value" (conventions.md,
// "Containers").
#pragma once

#include <array>
#include <charconv>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "formats/identity.h"

namespace tempolux::formats {

inline constexpr std::size_t kMaxTextSize = std::size_t(1) << 20;

/// The shortest text of a number that reads back as the same.
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

/// No control characters (bytes below 20 hex, or 7F).
bool is_printable(std::string_view text);

/// What every container's header has, by place: made with common_keys(header).
struct CommonKeys {
  std::string& history;
  Identity& identity;
  std::array<double, 3>& origin;
};
template <class Header>
CommonKeys common_keys(Header& header) {
  return {header.history, header.identity, header.origin};
}

/// What is wrong with origin and identity, as reader and writer both see it; "" if nothing.
std::string_view fault_of_common(const std::array<double, 3>& origin, const Identity& identity);

/// Is it the value of a key `part`? "" stands for no such line: the file holds all light.
bool is_part(std::string_view text);

/// What became of one line.
enum class Line { good, bad_value, unknown_key };

/// Takes the value of `origin`, `frames`, an identity hash or `history`; of another key: unknown_key.
Line take_common_line(std::string_view key, std::string_view value, const CommonKeys& keys);

/// What is wrong with a header's text, and where in it.
struct HeaderError {
  std::size_t offset = 0;
  std::string reason;
};

/// Cuts a text into lines and gives each to `take`. Keys other than history must not come twice, those of
/// `required` must come; unknown ones pass if `allow_unknown`. Nothing if the text is good.
std::optional<HeaderError> parse_lines(std::string_view text, bool allow_unknown,
                                       std::span<const std::string_view> required,
                                       const std::function<Line(std::string_view, std::string_view)>& take);

/// Makes the text of a header, line by line.
class HeaderText {
 public:
  /// `format` is for messages: "photons".
  explicit HeaderText(std::string_view format) : format_(format) {}

  void line(std::string_view key, std::string_view value);
  void origin(const std::array<double, 3>& origin);
  /// The lines of an identity; none if it is not known.
  void identity(const Identity& identity);
  /// One line for each of the history.
  void history(std::string_view history);
  /// The text. std::invalid_argument if a value has a control character or all is too long.
  std::string finish() const;
  /// Throws std::invalid_argument "FORMAT header: REASON".
  [[noreturn]] void refuse(std::string_view reason) const;

 private:
  std::string format_, text_;
};

}  // namespace tempolux::formats
