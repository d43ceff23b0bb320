// lib/core/formatted.h -- numbers as text, in printf's notation.
#pragma once

#include <cstdio>
#include <string>

namespace tempolux {

/// The text that printf would write for `pattern` and `values`, cut after 511 bytes.
template <class... Values>
std::string formatted(const char* pattern, Values... values) {
  char text[512];
  std::snprintf(text, sizeof text, pattern, values...);
  return text;
}

}  // namespace tempolux
