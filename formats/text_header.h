// formats/text_header.h -- writes and parses the text of a container's header: lines "key: value" (conventions.md,
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

/// The shortest text of a number from which parsing returns the same number.
template <class T>
std::string text_of(T number) {
  std::array<char, 32> text;
  return {text.data(), std::to_chars(text.data(), text.data() + text.size(), number).ptr};
}

/// Parses `count` numbers separated by one space; false if the text has another form.
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

/// True if the text has no control characters (bytes below 20 hex, or 7F).
bool is_printable(std::string_view text);

/// References to the header fields that all containers have; common_keys(header) makes it.
struct CommonKeys {
  std::string& history;
  Identity& identity;
  std::array<double, 3>& origin;
};
template <class Header>
CommonKeys common_keys(Header& header) {
  return {header.history, header.identity, header.origin};
}

/// Checks origin and identity for both reader and writer: returns the fault, or "" if there is none.
std::string_view fault_of_common(const std::array<double, 3>& origin, const Identity& identity);

/// True if the text is a value of the key `part`: "low", "high", or "" if there is no such line, which means that the
/// file holds all light.
bool is_part(std::string_view text);

/// Result of parsing one line.
enum class Line { good, bad_value, unknown_key };

/// Parses the value of `origin`, `frames`, an identity hash or `history`; returns unknown_key for any other key.
Line take_common_line(std::string_view key, std::string_view value, const CommonKeys& keys);

/// A fault of a header's text, and its position.
struct HeaderError {
  std::size_t offset = 0;
  std::string reason;
};

/// Cuts a text into lines and passes each to `take`. Every key except history may come only once, and all keys in
/// `required` must come. Unknown keys are accepted if `allow_unknown` is set. Returns nothing if the text is valid.
std::optional<HeaderError> parse_lines(std::string_view text, bool allow_unknown,
                                       std::span<const std::string_view> required,
                                       const std::function<Line(std::string_view, std::string_view)>& take);

/// Builds the text of a header line by line.
class HeaderText {
 public:
  /// `format` is the name in messages: "photons".
  explicit HeaderText(std::string_view format) : format_(format) {}

  void line(std::string_view key, std::string_view value);
  void origin(const std::array<double, 3>& origin);
  /// Appends the lines of an identity; none if the identity is unknown.
  void identity(const Identity& identity);
  /// Appends one line for each line of the history.
  void history(std::string_view history);
  /// Returns the text. Throws std::invalid_argument if a value has a control character or the text is too long.
  std::string finish() const;
  /// Throws std::invalid_argument "FORMAT header: REASON".
  [[noreturn]] void refuse(std::string_view reason) const;

 private:
  std::string format_, text_;
};

}  // namespace tempolux::formats
