#include "formats/container.h"

#include <algorithm>
#include <bit>

#include "formats/crc32.h"

namespace tempolux::formats {
namespace {

/// Largest number of words in the head of a block. A head is: mark, words, checksum.
constexpr std::size_t kMaxWords = 4;

}  // namespace

std::string hex_of(std::span<const double> values) {
  constexpr std::string_view digits = "0123456789abcdef";
  std::string text;
  for (double x : values)
    for (unsigned char byte : std::bit_cast<std::array<unsigned char, 8>>(x)) {
      text += digits[byte >> 4];
      text += digits[byte & 15];
    }
  return text;
}

void Chain::add(std::uint32_t crc) { crc_ = crc32(&crc, sizeof(crc), crc_); }

std::uint32_t Chain::over(std::string_view end_block) const { return crc32(end_block.data(), end_block.size(), crc_); }

std::size_t begin_block(std::string& bytes, std::string_view mark, std::span<const std::uint32_t> words) {
  const std::size_t head = bytes.size();
  bytes.append(mark);
  put_array(bytes, words);
  put(bytes, std::uint32_t(0));
  return head;
}

std::uint32_t seal_block(std::string& bytes, std::size_t head, std::size_t word_count) {
  const std::size_t place = head + kMarkSize + 4 * word_count, body = place + 4;
  const std::uint32_t crc = crc32(bytes.data() + body, bytes.size() - body, crc32(bytes.data() + head, place - head));
  std::memcpy(bytes.data() + place, &crc, sizeof(crc));
  return crc;
}

ContainerWriter::ContainerWriter(Sink sink, const Format& format, std::string_view text) : sink_(std::move(sink)) {
  std::string bytes(format.magic);
  put(bytes, format.major);
  put(bytes, format.minor);
  put(bytes, std::uint32_t(text.size()));
  bytes += text;
  const std::uint32_t crc = crc32(bytes.data(), bytes.size());
  put(bytes, crc);
  chain_.add(crc);
  sink_(bytes.data(), bytes.size());
}

void ContainerWriter::write_block(std::string_view mark, std::initializer_list<std::uint32_t> words,
                                  std::string_view body) {
  std::string bytes;
  bytes.reserve(kMarkSize + 4 * words.size() + 4 + body.size());
  const std::size_t head = begin_block(bytes, mark, {words.begin(), words.size()});
  bytes.append(body);
  const std::uint32_t crc = seal_block(bytes, head, words.size());
  write_sealed(bytes, {&crc, 1});
}

void ContainerWriter::write_sealed(std::string_view bytes, std::span<const std::uint32_t> checksums) {
  for (std::uint32_t crc : checksums) chain_.add(crc);
  sink_(bytes.data(), bytes.size());
}

void ContainerWriter::finish(std::string_view body) {
  std::string bytes(kEndMark);
  bytes.append(body);
  put(bytes, chain_.over(bytes));
  sink_(bytes.data(), bytes.size());
  finished_ = true;
}

ContainerReader::ContainerReader(const std::string& path, const Format& format) : bytes_(path) {
  std::array<unsigned char, kHeaderFixedSize> fixed{};
  bytes_.read(fixed.data(), format.magic.size(), "the header");
  if (std::memcmp(fixed.data(), format.magic.data(), format.magic.size()) != 0)
    bytes_.fail(0, "not a " + std::string(format.name) + " file",
                "give a file that " + std::string(format.written_by) + " wrote");
  bytes_.read(fixed.data() + format.magic.size(), kHeaderFixedSize - format.magic.size(), "the header");
  const auto major = get<std::uint16_t>(&fixed[8]), minor = get<std::uint16_t>(&fixed[10]);
  if (major != format.major)
    bytes_.fail(8, "version " + std::to_string(major) + "." + std::to_string(minor) + " of " + std::string(format.name),
                "this program reads version " + std::to_string(format.major) + ": make the file again with it");
  minor_ = minor;
  later_minor_ = minor > format.minor;
  const auto text_size = get<std::uint32_t>(&fixed[12]);
  if (text_size > kMaxTextSize) bytes_.fail(12, "header text of " + std::to_string(text_size) + " bytes");
  bytes_.expect(std::uint64_t(text_size) + 4, "the header");
  text_.resize(text_size);
  bytes_.read(text_.data(), text_.size(), "the header");
  std::uint32_t crc = 0;
  bytes_.read(&crc, sizeof(crc), "the header");
  if (crc != crc32(text_.data(), text_.size(), crc32(fixed.data(), fixed.size())))
    bytes_.fail(bytes_.offset() - 4, "wrong checksum of the header");
  chain_.add(crc);
}

void ContainerReader::expect_good(const std::optional<HeaderError>& error) const {
  if (error) bytes_.fail(kHeaderFixedSize + error->offset, error->reason, "correct the program that wrote it");
}

std::string ContainerReader::read_mark() {
  std::string mark(kMarkSize, '\0');
  bytes_.read(mark.data(), mark.size(), "the head of a block");
  return mark;
}

void ContainerReader::read_head(std::string_view mark, std::span<std::uint32_t> words, const char* what) {
  std::array<std::uint32_t, kMaxWords> head{};
  bytes_.read(head.data(), 4 * (words.size() + 1), what);
  std::copy_n(head.begin(), words.size(), words.begin());
  expected_crc_ = head[words.size()];
  crc_ = crc32(head.data(), 4 * words.size(), crc32(mark.data(), mark.size()));
  body_offset_ = bytes_.offset();
}

void ContainerReader::read_body(void* data, std::size_t size, const char* what) {
  bytes_.read(data, size, what);
  crc_ = crc32(data, size, crc_);
}

void ContainerReader::end_block(const char* what) {
  if (crc_ != expected_crc_) bytes_.fail(body_offset_ - 4, std::string("wrong checksum of ") + what);
  chain_.add(crc_);
}

bool ContainerReader::read_records(std::string_view mark, std::size_t record_size, std::vector<char>& body) {
  const std::uint64_t start = bytes_.offset();
  const std::string found = read_mark();
  if (found == kEndMark) return false;
  if (found != mark) bytes_.fail(start, "not the mark of a block that may stand here");
  std::uint32_t count = 0;
  read_head(mark, {&count, 1}, "the head of a block");
  if (count > kMaxBlockCount) bytes_.fail(start + 4, "block of " + std::to_string(count) + " records");
  bytes_.expect(std::uint64_t(count) * record_size, "a block");
  body.resize(count * record_size);
  read_body(body.data(), body.size(), "a block");
  end_block("a block");
  return true;
}

std::string ContainerReader::read_end(std::size_t size) {
  body_offset_ = bytes_.offset();
  std::string block(kEndMark);
  block.resize(kMarkSize + size);
  bytes_.read(block.data() + kMarkSize, size, "the end block");
  std::uint32_t chain = 0;
  bytes_.read(&chain, sizeof(chain), "the end block");
  if (chain != chain_.over(block)) bytes_.fail(bytes_.offset() - 4, "wrong checksum of the whole file");
  return block.substr(kMarkSize);
}

}  // namespace tempolux::formats
