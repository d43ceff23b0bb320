// formats/container.h -- the parts that all our containers share: header, blocks with checksums, end block, chain of
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

/// The constants of one container format.
struct Format {
  std::string_view magic;       ///< 8 bytes
  std::string_view name;        ///< ".photons"
  std::string_view written_by;  ///< names of the tools that write it, for remedies: "photon-trace"
  std::uint16_t major = 1, minor = 0;
};

inline constexpr std::size_t kHeaderFixedSize = 16, kMarkSize = 4;
inline constexpr std::string_view kEndMark = "END!";
inline constexpr std::uint32_t kMaxBlockCount = 65536;  ///< largest number of records in a block

/// Appends the bytes of a value or an array as they are in memory.
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

/// Hexadecimal digits of the bytes of float64 numbers, 16 digits each; for digests.
std::string hex_of(std::span<const double> values);

/// A CRC over the header's checksum, then over every block's checksum, then over the end block.
class Chain {
 public:
  void add(std::uint32_t crc);
  /// The chain's value after the end block.
  std::uint32_t over(std::string_view end_block) const;

 private:
  std::uint32_t crc_ = 0;
};

/// Appends the head of a block: mark, words, and room for the checksum. Returns the head's offset for seal_block(),
/// which is called after the body was appended.
std::size_t begin_block(std::string& bytes, std::string_view mark, std::span<const std::uint32_t> words);
/// Fills in and returns the checksum of the block that begins at `head`, has `word_count` words, and ends with
/// `bytes`.
std::uint32_t seal_block(std::string& bytes, std::size_t head, std::size_t word_count);

/// Writes a container front to back.
class ContainerWriter {
 public:
  using Sink = std::function<void(const void*, std::size_t)>;
  /// Writes the header.
  ContainerWriter(Sink sink, const Format& format, std::string_view text);

  void write_block(std::string_view mark, std::initializer_list<std::uint32_t> words, std::string_view body);
  /// Writes blocks that were sealed elsewhere; `checksums` holds the checksum of each block, in order.
  void write_sealed(std::string_view bytes, std::span<const std::uint32_t> checksums);
  /// Writes the end block: mark, `body`, chain.
  void finish(std::string_view body);
  bool finished() const { return finished_; }

 private:
  Sink sink_;
  Chain chain_;
  bool finished_ = false;
};

/// Reads a container front to back. Every fault of the file is an InputError "FILE: byte OFFSET: ...".
class ContainerReader {
 public:
  /// Reads the header: magic, version, checksum. "-" is standard input.
  ContainerReader(const std::string& path, const Format& format);

  const std::string& text() const { return text_; }
  std::uint16_t minor() const { return minor_; }
  /// True if the file has a later minor version than this program knows. Unknown header keys are then accepted.
  bool later_minor() const { return later_minor_; }
  /// Calls fail() if `error` holds an error of the header's text.
  void expect_good(const std::optional<HeaderError>& error) const;

  /// Reads the next mark, four bytes.
  std::string read_mark();
  /// Reads the words and the checksum that follow a mark. The body of the block begins after them.
  void read_head(std::string_view mark, std::span<std::uint32_t> words, const char* what);
  /// Reads the next `size` bytes of the block's body.
  void read_body(void* data, std::size_t size, const char* what);
  /// Calls fail() if the checksum of the body read since read_head() differs from the head's.
  void end_block(const char* what);
  /// Reads a block "mark count checksum body" of records into `body`, count * record_size bytes. Returns false at the
  /// end mark; any other mark fails.
  bool read_records(std::string_view mark, std::size_t record_size, std::vector<char>& body);
  /// Reads the end block after its mark: `size` bytes and the chain. Calls fail() if the chain is wrong. Returns the
  /// `size` bytes; body_offset() is their offset in the file. The caller checks their content first, then calls
  /// bytes().expect_end().
  std::string read_end(std::size_t size);

  ByteReader& bytes() { return bytes_; }
  const ByteReader& bytes() const { return bytes_; }
  /// Offset in the file of the body that was begun last.
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
