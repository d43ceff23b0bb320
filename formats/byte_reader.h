// formats/byte_reader.h -- reads a file or a pipe front to back and counts bytes, so that messages can give the
// offset.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace tempolux::formats {

/// Bytes of a file in order. Small reads come from a buffer, large ones go straight to their place.
class ByteReader {
 public:
  /// "-" is standard input. Throws InputError if the file cannot be opened or is a folder.
  explicit ByteReader(const std::string& path);
  ~ByteReader();
  ByteReader(const ByteReader&) = delete;
  ByteReader& operator=(const ByteReader&) = delete;

  /// Reads the next `size` bytes into `data`. If there are fewer, calls fail() with "ends inside WHAT". Throws
  /// ResourceError if the system cannot read.
  void read(void* data, std::size_t size, const char* what);
  /// Calls fail() if fewer than `size` more bytes can follow. The size of a pipe is unknown, so every size passes.
  /// Call it with every count from the file before memory is allocated for that count.
  void expect(std::uint64_t size, const char* what);
  /// Calls fail() if there is another byte.
  void expect_end();

  /// Bytes read so far.
  std::uint64_t offset() const { return offset_; }
  /// Number of bytes from where the file was opened to its end; 0 for a pipe.
  std::uint64_t size() const { return known_size_ ? size_ : 0; }

  /// Throws InputError "FILE: byte OFFSET: REASON; REMEDY".
  [[noreturn]] void fail(std::uint64_t offset, const std::string& reason) const;
  [[noreturn]] void fail(std::uint64_t offset, const std::string& reason, const std::string& remedy) const;

 private:
  std::size_t read_some(void* data, std::size_t size);

  std::string name_;
  int file_ = -1;
  bool known_size_ = false;
  std::uint64_t size_ = 0, offset_ = 0;
  std::vector<unsigned char> buffer_;
  std::size_t buffer_first_ = 0, buffer_last_ = 0;
};

}  // namespace tempolux::formats
