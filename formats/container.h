// formats/container.h -- what all our containers share: header, blocks with checksums, end block, chain of
// checksums (conventions.md, "Containers").
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <functional>
#include <initializer_list>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "formats/byte_reader.h"
#include "formats/text_header.h"

namespace tempolux::formats {

/// One of our containers.
struct Format {
  std::string_view magic;       ///< 8 bytes
  std::string_view name;        ///< ".photons"
  std::string_view written_by;  ///< the tools, for a remedy: "photon-trace"
  std::uint16_t major = 1, minor = 0;
};

inline constexpr std::size_t kHeaderFixedSize = 16, kMarkSize = 4;
inline constexpr std::string_view kEndMark = "END!";
inline constexpr std::uint32_t kMaxBlockCount = 65536;  ///< records of one block

/// Appends a value, or an array, as it lies in memory.
template <class T>
void put(std::string& bytes, const T& value) {
  bytes.append(reinterpret_cast<const char*>(&value), sizeof(T));
}
template <class T>
void put_array(std::string& bytes, std::span<const T> values) {
  bytes.append(reinterpret_cast<const char*>(values.data()), values.size_bytes());
}
template <class T>
T get(const void* bytes) {
  T value;
  std::memcpy(&value, bytes, sizeof(T));
  return value;
}

/// Three float64 as the 48 hexadecimal digits of their bytes (8 bytes: 16 digits each), for digests.
std::string hex_of(std::span<const double> values);

/// CRC of a header's checksum, then of every block's, then of the end block.
class Chain {
 public:
  void add(std::uint32_t crc);
  /// The closing value: continued over the end block.
  std::uint32_t over(std::string_view end_block) const;

 private:
  std::uint32_t crc_ = 0;
};

/// Appends a block's head: mark, words, room for the checksum. Returns its offset, for seal_block() when the
/// body has been appended.
std::size_t begin_block(std::string& bytes, std::string_view mark, std::span<const std::uint32_t> words);
/// Fills in the checksum of the block of so many words that begins at `head` and ends with `bytes`; returns
/// it.
std::uint32_t seal_block(std::string& bytes, std::size_t head, std::size_t word_count);

/// Writes a container front to back.
class ContainerWriter {
 public:
  using Sink = std::function<void(const void*, std::size_t)>;
  /// Writes the header.
  ContainerWriter(Sink sink, const Format& format, std::string_view text);

  void write_block(std::string_view mark, std::initializer_list<std::uint32_t> words, std::string_view body);
  /// Bytes of sealed blocks made elsewhere, and the checksum of each of them in order.
  void write_sealed(std::string_view bytes, std::span<const std::uint32_t> checksums);
  /// Writes the end block: mark, `body`, chain.
  void finish(std::string_view body);
  bool finished() const { return finished_; }

 private:
  Sink sink_;
  Chain chain_;
  bool finished_ = false;
};

/// Reads a container front to back. Everything that is wrong is an InputError "FILE: byte OFFSET: ...".
class ContainerReader {
 public:
  /// Reads the header: magic, version, checksum. "-" is standard input.
  ContainerReader(const std::string& path, const Format& format);

  const std::string& text() const { return text_; }
  std::uint16_t minor() const { return minor_; }
  /// Of a later minor version than the format's: unknown keys pass.
  bool later_minor() const { return later_minor_; }
  /// fail()s if parsing the text found an error.
  void expect_good(const std::optional<HeaderError>& error) const;

  /// The next mark of four bytes.
  std::string read_mark();
  /// What follows a mark: these words and the checksum. The block begins.
  void read_head(std::string_view mark, std::span<std::uint32_t> words, const char* what);
  /// More of the block's body.
  void read_body(void* data, std::size_t size, const char* what);
  /// fail()s unless the body read since read_head() has the head's checksum.
  void end_block(const char* what);
  /// A block of records alone, "mark count checksum body": its body into `body`, count * record_size bytes.
  /// False at the end mark; fail()s at any other.
  bool read_records(std::string_view mark, std::size_t record_size, std::vector<char>& body);
  /// The end block, its mark read already: mark, `size` bytes, chain. fail()s unless the chain is right.
  /// Returns the bytes between, which body_offset() is the place of. What they say comes first; then
  /// bytes().expect_end().
  std::string read_end(std::size_t size);

  ByteReader& bytes() { return bytes_; }
  const ByteReader& bytes() const { return bytes_; }
  /// Offset of the body begun last.
  std::uint64_t body_offset() const { return body_offset_; }

 private:
  ByteReader bytes_;
  std::string text_;
  std::uint16_t minor_ = 0;
  bool later_minor_ = false;
  Chain chain_;
  std::uint32_t crc_ = 0, expected_crc_ = 0;
  std::uint64_t body_offset_ = 0;
};

}  // namespace tempolux::formats
