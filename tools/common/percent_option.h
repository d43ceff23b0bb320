// tools/common/percent_option.h -- limits given as a number, or as a share of pixels that ends in "%".
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <utility>

#include "tools/common/cli.h"

namespace tempolux::tools {

/// The share that a word as "5%" names: .05. Empty for other words.
inline std::optional<double> share_in_percent(const std::string& word) {
  double number = 0;
  if (!word.ends_with("%") || !CLI::detail::lexical_cast(word.substr(0, word.size() - 1), number)) return std::nullopt;
  return number / 100;
}

/// For transform(): rewrites "5%" as 0.05 and calls `given`, if there is one; other words stay unchanged.
inline CLI::Validator percent(std::function<void()> given = {}) {
  return CLI::Validator(
      [given = std::move(given)](std::string& word) {
        const std::optional<double> share = share_in_percent(word);
        if (!share) return std::string();
        word = std::to_string(*share);
        if (given) given();
        return std::string();
      },
      "");
}

}  // namespace tempolux::tools
