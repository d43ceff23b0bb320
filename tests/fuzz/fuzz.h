// tests/fuzz/fuzz.h -- what the fuzz targets share. Each target is one function of bytes; libFuzzer calls it
// millions of times with bytes of its own making, replay.cpp with those of tests/fuzz/corpus and near them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>
#include <string_view>

#include "formats/error.h"

namespace tempolux::fuzz {

/// Writes the bytes to the one file of this process that readers are given; returns its path. It lies in a
/// folder of its own, in memory where there is /dev/shm, that is removed at the end.
std::string file_of(const std::uint8_t* data, std::size_t size, const std::string& extension);

/// Runs `read`. An InputError of one line is what bad input must give; anything else ends the process: other
/// exceptions, and messages of several lines, without the file's name, or of more than 2000 bytes.
void expect_read_or_refused(const std::string& path, const std::function<void()>& read);

/// One of our containers with the checksums of header and blocks made right again, so that a changed byte is
/// met by what lies behind them. Bytes that are no container stay as they are.
std::string with_right_checksums(std::string bytes);

}  // namespace tempolux::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);
