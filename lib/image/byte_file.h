// lib/image/byte_file.h -- a regular file read at given offsets, safely from several threads.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace tempolux {

/// A file opened for reading.
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

/// Reads a ByteFile through a buffer, for many small reads at neighbouring places. For one thread. The file must
/// outlive it.
class BufferedFile {
 public:
  explicit BufferedFile(const ByteFile& file) : file_(file), buffer_(kBufferSize) {}
  /// As ByteFile::read_at().
  void read_at(std::uint64_t offset, void* to, std::size_t count);

 private:
  static constexpr std::size_t kBufferSize = 16384;
  const ByteFile& file_;
  std::vector<char> buffer_;
  std::uint64_t start_ = 0;  ///< place of the buffer in the file
  std::size_t filled_ = 0;
};

/// Creates or truncates `path` and writes the pieces in order, without seeking or syncing. Throws ResourceError with
/// the reason.
void write_pieces(const std::string& path, std::span<const std::string> pieces);

/// The message of another library as one line: at most 1 KB, spaces in place of control characters, no full stop at the
/// end.
std::string one_line(const std::string& text);

}  // namespace tempolux
