// lib/core/check.h -- stops the program at a programming error; errors of input and system are exceptions.
#pragma once

#include <cstdio>
#include <cstdlib>

/// Prints file, line and condition, and aborts, if the condition is false. The file's name has no folder, so builds in
/// two folders have equal bytes. Use the macro for errors of the program only. An error in a file or an option is an
/// InputError.
#define TEMPOLUX_CHECK(condition)                                                               \
  do {                                                                                          \
    if (!(condition)) {                                                                         \
      std::fprintf(stderr, "%s:%d: broken promise: %s\n", __FILE_NAME__, __LINE__, #condition); \
      std::abort();                                                                             \
    }                                                                                           \
  } while (false)
