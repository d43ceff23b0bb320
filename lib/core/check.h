// lib/core/check.h -- stops the program at a programming error; errors of input and system are exceptions.
#pragma once

#include <cstdio>
#include <cstdlib>

/// Aborts with the name of the file without its folder, so that builds in two folders have equal bytes, line and the
/// condition. Only for errors of the program: an error in a file or an option is an InputError.
#define TEMPOLUX_CHECK(condition)                                                               \
  do {                                                                                          \
    if (!(condition)) {                                                                         \
      std::fprintf(stderr, "%s:%d: broken promise: %s\n", __FILE_NAME__, __LINE__, #condition); \
      std::abort();                                                                             \
    }                                                                                           \
  } while (false)
