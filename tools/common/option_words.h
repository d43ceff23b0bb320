// tools/common/option_words.h -- names of values and limits of numbers, in --help and in the man page.
#pragma once

#include <limits>
#include <string>

#include "tools/common/cli.h"

namespace tempolux::tools {

/// Accepts a number from `least` to `most`; --help and errors show the limits. Without `most`: `least` or more.
CLI::Validator number_between(double least, double most = std::numeric_limits<double>::infinity());
/// A finite number greater than this.
CLI::Validator number_above(double limit);

/// The word that help texts show for an option's value: "N", "FILE...", "{raw,spec}".
std::string value_name(const CLI::Option& option);
/// "1 to 512" if it has limits, else "".
std::string limits_of(const CLI::Option& option);
/// The positional arguments of a tool: "[points|records] SCENE", "test [reference]".
std::string positional_words(const CLI::App& app);

}  // namespace tempolux::tools
