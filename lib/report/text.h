// lib/report/text.h -- formats numbers as cells of a table.
#pragma once

#include <optional>
#include <string>

#include "lib/core/formatted.h"

namespace tempolux {

/// A number in printf's notation; "" if there is none.
inline std::string number_text(std::optional<double> value, const char* pattern = "%.4g") {
  return value ? formatted(pattern, *value) : "";
}

}  // namespace tempolux
