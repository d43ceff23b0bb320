// lib/report/text.h -- formats numbers as cells of a table.
#pragma once

#include <cstdio>
#include <optional>
#include <string>

namespace tempolux {

/// A number in printf's notation; empty if there is none.
inline std::string number_text(std::optional<double> value, const char* pattern = "%.4g") {
  if (!value) return "";
  char text[64];
  std::snprintf(text, sizeof text, pattern, *value);
  return text;
}

}  // namespace tempolux
