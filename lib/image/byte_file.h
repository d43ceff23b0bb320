// lib/image/byte_file.h -- a regular file read at given offsets, safely from several threads.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

namespace tempolux {

class ByteFile {
 public:
  /// Throws InputError if `path` cannot be opened or is not a regular file.
  explicit ByteFile(std::string path);
  ~ByteFile();
  ByteFile(const ByteFile&) = delete;
  ByteFile& operator=(const ByteFile&) = delete;

  const std::string& path() const { return path_; }
  std::uint64_t size() const { return size_; }
  /// Fills all of `to`; throws InputError "FILE: byte N: ends here ..." if the file ends first. Thread-safe.
  void read_at(std::uint64_t offset, void* to, std::size_t count) const;

 private:
  std::string path_;
  int descriptor_ = -1;
  std::uint64_t size_ = 0;
};

/// Creates or truncates `path` and writes the pieces in order, without seeking or syncing. Throws ResourceError with
/// the reason.
void write_pieces(const std::string& path, std::span<const std::string> pieces);

/// Makes a foreign library's message fit for one line: control characters become spaces, at most 1 KB.
std::string one_line(const std::string& text);

}  // namespace tempolux
