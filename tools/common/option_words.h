// tools/common/option_words.h -- what an option is called in --help and in the man page, and the limits of numbers.
#pragma once

#include <CLI/CLI.hpp>
#include <limits>
#include <string>

namespace tempolux::tools {

/// A number from `least` to `most`; --help shows the limits, and so does the error. Without `most`: least or more.
CLI::Validator number_between(double least, double most = std::numeric_limits<double>::infinity());
/// A finite number greater than this.
CLI::Validator number_above(double limit);

/// What stands for an option's value: "N", "FILE...", "{raw,spec}".
std::string value_name(const CLI::Option& option);
/// "1 to 512" if it has limits, else "".
std::string limits_of(const CLI::Option& option);
/// The arguments that are no options, as they are typed: "[points|records] SCENE", "test [reference]".
std::string positional_words(const CLI::App& app);

}  // namespace tempolux::tools
