#include "formats/photons/file_reader.h"

#include <cmath>
#include <cstring>

#include "formats/crc32.h"

namespace tempolux::formats::photons {
namespace {

template <class T>
T get(const unsigned char* bytes) {
  T value;
  std::memcpy(&value, bytes, sizeof(T));
  return value;
}

bool has_mark(const unsigned char* bytes, std::string_view mark) {
  return std::memcmp(bytes, mark.data(), 4) == 0;
}

/// Makes room for exactly `count` values without touching those of a buffer that already has as many.
template <class T>
void resize(std::vector<T>& values, std::size_t count) {
  if (values.size() != count) values.resize(count);
}

}  // namespace

FileReader::FileReader(const std::string& path) : bytes_(path) { read_header(); }

void FileReader::read_header() {
  std::array<unsigned char, kHeaderFixedSize> fixed{};
  bytes_.read(fixed.data(), kMagic.size(), "the header");
  if (std::memcmp(fixed.data(), kMagic.data(), kMagic.size()) != 0)
    bytes_.fail(0, "not a .photons file", "give a file that photon-trace or photonmap-split wrote");
  bytes_.read(fixed.data() + kMagic.size(), kHeaderFixedSize - kMagic.size(), "the header");
  const auto major = get<std::uint16_t>(&fixed[8]), minor = get<std::uint16_t>(&fixed[10]);
  if (major != kVersionMajor)
    bytes_.fail(8, "version " + std::to_string(major) + "." + std::to_string(minor) + " of .photons",
                "this program reads version 1: make the file again with it");
  const auto text_size = get<std::uint32_t>(&fixed[12]);
  if (text_size > kMaxTextSize) bytes_.fail(12, "header text of " + std::to_string(text_size) + " bytes");
  bytes_.expect(std::uint64_t(text_size) + 4, "the header");
  std::string text(text_size, '\0');
  bytes_.read(text.data(), text.size(), "the header");
  std::uint32_t crc = 0;
  bytes_.read(&crc, 4, "the header");
  if (crc != crc32(text.data(), text.size(), crc32(fixed.data(), fixed.size())))
    bytes_.fail(bytes_.offset() - 4, "wrong checksum of the header");
  if (const auto error = parse_header_text(text, minor > kVersionMinor, header_))
    bytes_.fail(kHeaderFixedSize + error->offset, error->reason, "correct the program that wrote it");
  chain_ = crc32(&crc, 4);
  rules_ = rules_of(header_);
}

bool FileReader::read_block(PhotonBlock& block) {
  if (ended_) return false;
  for (;;) {
    std::array<unsigned char, kBlockHeadSize> head{};
    const std::uint64_t start = bytes_.offset();
    bytes_.read(head.data(), 4, "the head of a block");
    if (has_mark(head.data(), kLedgerMark) && !has_ledger_) {
      read_ledger();
      continue;
    }
    if (has_mark(head.data(), kEndMark)) {
      read_end();
      return false;
    }
    if (!has_mark(head.data(), kBlockMark) || has_ledger_)
      bytes_.fail(start, "not the mark of a block that may stand here");
    bytes_.read(&head[4], kBlockHeadSize - 4, "the head of a block");
    block.group = get<std::uint32_t>(&head[4]);
    const auto count = get<std::uint32_t>(&head[8]);
    if (block.group >= header_.group_count)
      bytes_.fail(start + 4,
                  "group " + std::to_string(block.group) + " of " + std::to_string(header_.group_count));
    if (block.group < last_group_)
      bytes_.fail(start + 4, "group " + std::to_string(block.group) + " after a later one");
    if (count > kMaxBlockCount) bytes_.fail(start + 8, "block of " + std::to_string(count) + " photons");
    read_body(block, count, crc32(head.data(), 12), get<std::uint32_t>(&head[12]));
    last_group_ = block.group;
    if (is_overlay() && (groups_.empty() || groups_.back() != block.group)) groups_.push_back(block.group);
    return true;
  }
}

void FileReader::read_body(PhotonBlock& block, std::size_t count, std::uint32_t crc, std::uint32_t expected) {
  const std::uint64_t start = bytes_.offset();
  bytes_.expect(std::uint64_t(count) * photon_size(header_.columns), "a block");
  resize(block.photons, count);
  resize(block.directions, header_.columns & column_direction ? count : 0);
  resize(block.albedos, header_.columns & column_albedo ? count : 0);
  const auto read = [&](auto& values) {
    bytes_.read(values.data(), values.size() * sizeof(values[0]), "a block");
    crc = crc32(values.data(), values.size() * sizeof(values[0]), crc);
  };
  read(block.photons);
  read(block.directions);
  read(block.albedos);
  if (crc != expected) bytes_.fail(start - 4, "wrong checksum of a block");
  check_body(block, start);
  chain_ = crc32(&crc, 4, chain_);
  photon_count_ += count;
  stored_flux_.add(block.photons);
}

void FileReader::check_body(const PhotonBlock& block, std::uint64_t start) const {
  if (const auto bad = find_bad_photon(block.photons, rules_))
    bytes_.fail(start + 32 * bad->index,
                "photon " + std::to_string(bad->index) + " of the block: " + std::string(bad->reason),
                "correct the program that wrote it");
  if (const auto bad = find_bad_direction(block.directions))
    bytes_.fail(start + 32 * block.photons.size() + 4 * bad->index,
                "photon " + std::to_string(bad->index) + " of the block: " + std::string(bad->reason),
                "correct the program that wrote it");
}

void FileReader::read_ledger() {
  std::array<unsigned char, kLedgerHeadSize> head{};
  std::memcpy(head.data(), kLedgerMark.data(), 4);
  bytes_.read(&head[4], kLedgerHeadSize - 4, "the ledger");
  const std::uint64_t start = bytes_.offset();
  const auto count = get<std::uint32_t>(&head[4]);
  const std::size_t expected = is_overlay() ? groups_.size() : header_.group_count;
  if (count != expected)
    bytes_.fail(start - 8,
                "ledger of " + std::to_string(count) + " groups instead of " + std::to_string(expected));
  bytes_.expect(std::uint64_t(count) * kLedgerEntrySize, "the ledger");
  std::uint32_t crc = crc32(head.data(), 8);
  std::array<unsigned char, kLedgerEntrySize> entry{};
  for (std::size_t i = 0; i < count; ++i) {
    bytes_.read(entry.data(), entry.size(), "the ledger");
    crc = crc32(entry.data(), entry.size(), crc);
    GroupFlux& group = ledger_.emplace_back();
    group.group = get<std::uint32_t>(entry.data());
    std::memcpy(group.emitted.data(), &entry[4], 24);
    std::memcpy(group.escaped.data(), &entry[28], 24);
    std::memcpy(group.absorbed.data(), &entry[52], 24);
  }
  if (crc != get<std::uint32_t>(&head[8])) bytes_.fail(start - 4, "wrong checksum of the ledger");
  for (std::size_t i = 0; i < count; ++i) {
    const std::uint64_t at = start + i * kLedgerEntrySize;
    if (ledger_[i].group != (is_overlay() ? groups_[i] : i))
      bytes_.fail(at, "the ledger's groups are not those of the file");
    check_flux(ledger_[i].emitted, at + 4, "emitted flux");
    check_flux(ledger_[i].escaped, at + 28, "escaped flux");
    check_flux(ledger_[i].absorbed, at + 52, "absorbed flux");
  }
  chain_ = crc32(&crc, 4, chain_);
  has_ledger_ = true;
}

void FileReader::read_end() {
  const std::uint64_t start = bytes_.offset() - 4;
  std::array<unsigned char, kEndSize> end{};
  std::memcpy(end.data(), kEndMark.data(), 4);
  bytes_.read(&end[4], kEndSize - 4, "the end block");
  if (get<std::uint32_t>(&end[108]) != crc32(end.data(), 108, chain_))
    bytes_.fail(start + 108, "wrong checksum of the whole file");
  totals_.photon_count = get<std::uint64_t>(&end[4]);
  std::memcpy(totals_.stored_flux.data(), &end[12], 24);
  std::memcpy(totals_.emitted_flux.data(), &end[36], 24);
  std::memcpy(totals_.escaped_flux.data(), &end[60], 24);
  std::memcpy(totals_.absorbed_flux.data(), &end[84], 24);
  if (totals_.photon_count != photon_count_)
    bytes_.fail(start + 4, "end block counts " + std::to_string(totals_.photon_count) +
                               " photons, the file has " + std::to_string(photon_count_));
  if (totals_.stored_flux != stored_flux_.rounded())
    bytes_.fail(start + 12, "stored flux is not the sum of the photons' flux");
  check_flux(totals_.emitted_flux, start + 36, "emitted flux");
  check_flux(totals_.escaped_flux, start + 60, "escaped flux");
  check_flux(totals_.absorbed_flux, start + 84, "absorbed flux");
  if (is_overlay() && !has_ledger_) bytes_.fail(start, "an overlay without ledger", "make it again");
  if (has_ledger_) {
    PhotonTotals sums = totals_;
    add_up(ledger_, sums);
    if (sums != totals_) bytes_.fail(start + 36, "totals are not the sums of the ledger");
  }
  bytes_.expect_end();
  ended_ = true;
}

void FileReader::check_flux(const std::array<double, 3>& flux, std::uint64_t offset, const char* name) const {
  for (std::size_t c = 0; c < 3; ++c)
    if (!std::isfinite(flux[c]) || (flux[c] < 0 && !rules_.signed_flux))
      bytes_.fail(offset + 8 * c, std::string(name) + " is not finite or is negative");
}

}  // namespace tempolux::formats::photons
