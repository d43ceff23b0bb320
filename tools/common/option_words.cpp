// tools/common/option_words.cpp -- texts and limits of options.
#include "tools/common/option_words.h"

#include <cmath>

#include "lib/core/formatted.h"

namespace tempolux::tools {
namespace {

std::string text_of(double value) { return formatted("%.10g", value); }

/// The part of the type that comes before the checks in CLI11's "INT:1 to 512" or "TEXT:{raw,spec}".
std::string before_colon(const std::string& type) { return type.substr(0, type.find(':')); }
std::string after_colon(const std::string& type) {
  const std::size_t colon = type.find(':');
  return colon == std::string::npos ? "" : type.substr(colon + 1);
}

/// Checks for numbers in [least, most], or in (least, most] if `above` is set. The text of the check is made on
/// demand, since every start of a tool creates dozens of checks.
class NumberCheck : public CLI::Validator {
 public:
  NumberCheck(double least, double most, bool above) {
    const auto limits = [=] {
      if (above) return "above " + text_of(least);
      return text_of(least) + (std::isinf(most) ? " or more" : " to " + text_of(most));
    };
    desc_function_ = limits;
    func_ = [=](std::string& text) -> std::string {
      double value = 0;
      if (CLI::detail::lexical_cast(text, value) && std::isfinite(value) && (above ? value > least : value >= least) &&
          value <= most)
        return "";
      return "'" + text + "' is not " + (above || std::isinf(most) ? "" : "from ") + limits();
    };
  }
};

}  // namespace

CLI::Validator number_between(double least, double most) { return NumberCheck(least, most, false); }

CLI::Validator number_above(double limit) { return NumberCheck(limit, INFINITY, true); }

std::string value_name(const CLI::Option& option) {
  const std::string type = option.get_type_name();
  std::string name = before_colon(type);
  if (name == "INT" || name == "UINT") name = "N";
  else if (name == "FLOAT") name = "X";
  const std::string words = after_colon(type);
  if (words.starts_with('{')) name = name == "TEXT" ? words : name + ":" + words;
  return (name.empty() ? "VALUE" : name) + (option.get_expected_max() > 1 ? "..." : "");
}

std::string limits_of(const CLI::Option& option) {
  const std::string words = after_colon(option.get_type_name());
  return words.starts_with('{') ? "" : words;
}

std::string positional_words(const CLI::App& app) {
  std::string words;
  for (const CLI::Option* option : app.get_options()) {
    if (!option->get_positional() || option->get_group().empty()) continue;
    const std::string type = option->get_type_name();
    const bool named = type.find(' ') != std::string::npos;  // words that the tool itself has set, no type of CLI11
    const std::string word = named ? type : option->get_single_name() + (option->get_expected_max() > 1 ? "..." : "");
    words += option->get_required() ? " " + word : " [" + word + "]";
  }
  return words;
}

}  // namespace tempolux::tools
