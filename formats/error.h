// formats/error.h -- the two kinds of errors that a tool reports: faults of the input, and failures of the machine.
#pragma once

#include <stdexcept>

namespace tempolux {

/// The input is invalid, stale or unsupported. The message names file, place and remedy. The tool exits with 2.
struct InputError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// The work cannot be done: no memory, a full disk, a failed write. The tool exits with 3.
struct ResourceError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

}  // namespace tempolux
