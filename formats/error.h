// formats/error.h -- the kinds of trouble a tool can be in, and whose fault each is.
#pragma once

#include <stdexcept>

namespace tempolux {

/// The input is bad, stale or unsupported. The message says file, place and remedy. A tool exits 2.
struct InputError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// The work could not be done: no memory, disk full, write failed. A tool exits 3.
struct ResourceError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

}  // namespace tempolux
