// lib/report/gnuplot.h -- draws plots with gnuplot as a child process.
#pragma once

#include <optional>
#include <string>

namespace tempolux {

/// Runs gnuplot with `script` as input and returns its standard output; empty: there is no gnuplot. The child is killed
/// after timeout_s seconds. Throws ResourceError if gnuplot fails (with its own message), takes too long or draws
/// nothing.
std::optional<std::string> run_gnuplot(const std::string& script, int timeout_s);

}  // namespace tempolux
