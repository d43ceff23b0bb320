// lib/report/gnuplot.h -- plots drawn by gnuplot as a child process.
#pragma once

#include <string>

namespace tempolux {

/// What gnuplot writes to its standard output when given `script` as input. The child is killed after
/// timeout_s seconds. Throws ResourceError if gnuplot is missing, fails (with its own words), takes too long
/// or draws nothing.
std::string run_gnuplot(const std::string& script, double timeout_s);

}  // namespace tempolux
