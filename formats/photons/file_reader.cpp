#include "formats/photons/file_reader.h"

#include <cmath>
#include <cstring>

namespace tempolux::formats::photons {
namespace {

/// Resizes to exactly `count` values. If the buffer already has as many, their content stays, which saves clearing
/// them.
template <class T>
void resize(std::vector<T>& values, std::size_t count) {
  if (values.size() != count) values.resize(count);
}

}  // namespace

FileReader::FileReader(const std::string& path) : in_(path, kFormat) {
  in_.expect_good(parse_header_text(in_.text(), in_.minor(), header_));
  rules_ = rules_of(header_);
}

bool FileReader::read_block(PhotonBlock& block) {
  if (ended_) return false;
  const ByteReader& bytes = in_.bytes();
  for (;;) {
    const std::uint64_t start = bytes.offset();
    const std::string mark = in_.read_mark();
    if (mark == ledger_mark(header_) && !has_ledger_) {
      read_ledger();
      continue;
    }
    if (mark == kEndMark) {
      read_end();
      return false;
    }
    if (mark != kBlockMark || has_ledger_) bytes.fail(start, "not the mark of a block that may stand here");
    std::array<std::uint32_t, 2> head{};
    in_.read_head(kBlockMark, head, "the head of a block");
    const auto [group, count] = head;
    if (group >= header_.group_count)
      bytes.fail(start + 4, "group " + std::to_string(group) + " of " + std::to_string(header_.group_count));
    if (group < last_group_) bytes.fail(start + 4, "group " + std::to_string(group) + " after a later one");
    if (count > kMaxBlockCount) bytes.fail(start + 8, "block of " + std::to_string(count) + " photons");
    block.group = last_group_ = group;
    read_body(block, count);
    if (is_overlay() && (groups_.empty() || groups_.back() != group)) groups_.push_back(group);
    return true;
  }
}

void FileReader::read_body(PhotonBlock& block, std::size_t count) {
  in_.bytes().expect(std::uint64_t(count) * photon_size(header_.columns), "a block");
  resize(block.photons, count);
  resize(block.directions, header_.columns & column_direction ? count : 0);
  resize(block.albedos, header_.columns & column_albedo ? count : 0);
  const auto read = [&](auto& values) { in_.read_body(values.data(), values.size() * sizeof(values[0]), "a block"); };
  read(block.photons);
  read(block.directions);
  read(block.albedos);
  in_.end_block("a block");
  check_body(block, in_.body_offset());
  photon_count_ += count;
  stored_flux_.add(block.photons);
}

void FileReader::check_body(const PhotonBlock& block, std::uint64_t start) const {
  if (const auto bad = find_bad_photon(block.photons, rules_))
    in_.bytes().fail(start + 32 * bad->index,
                     "photon " + std::to_string(bad->index) + " of the block: " + std::string(bad->reason),
                     "correct the program that wrote it");
  if (const auto bad = find_bad_direction(block.directions))
    in_.bytes().fail(start + 32 * block.photons.size() + 4 * bad->index,
                     "photon " + std::to_string(bad->index) + " of the block: " + std::string(bad->reason),
                     "correct the program that wrote it");
}

void FileReader::read_ledger() {
  const bool dated = has_tentative(header_);
  const std::size_t size = ledger_entry_size(header_);
  std::uint32_t count = 0;
  in_.read_head(ledger_mark(header_), {&count, 1}, "the ledger");
  const std::uint64_t start = in_.body_offset();
  const std::size_t expected = is_overlay() ? groups_.size() : header_.group_count;
  if (count != expected)
    in_.bytes().fail(start - 8,
                     "ledger of " + std::to_string(count) + " groups instead of " + std::to_string(expected));
  in_.bytes().expect(std::uint64_t(count) * size, "the ledger");
  std::vector<unsigned char> entry(size);
  for (std::size_t i = 0; i < count; ++i) {
    in_.read_body(entry.data(), size, "the ledger");
    GroupFlux& group = ledger_.emplace_back();
    group.group = get<std::uint32_t>(entry.data());
    std::memcpy(group.emitted.data(), &entry[4], 24);
    std::memcpy(group.escaped.data(), &entry[28], 24);
    std::memcpy(group.absorbed.data(), &entry[52], 24);
    if (!dated) continue;
    group.frame = get<std::int32_t>(&entry[76]);
    group.paths = get<std::uint64_t>(&entry[80]);
    group.pilots.resize(header_.pilots);
    if (header_.pilots > 0)
      std::memcpy(group.pilots.data(), &entry[kDatedLedgerEntrySize], header_.pilots * sizeof(PhotonPilot));
  }
  in_.end_block("the ledger");
  for (std::size_t i = 0; i < count; ++i) {
    const std::uint64_t at = start + i * size;
    if (ledger_[i].group != (is_overlay() ? groups_[i] : i))
      in_.bytes().fail(at, "the ledger's groups are not those of the file");
    check_flux(ledger_[i].emitted, at + 4, "emitted flux");
    check_flux(ledger_[i].escaped, at + 28, "escaped flux");
    check_flux(ledger_[i].absorbed, at + 52, "absorbed flux");
    for (std::size_t p = 0; p < ledger_[i].pilots.size(); ++p)
      if (!std::isfinite(ledger_[i].pilots[p].sketch))
        in_.bytes().fail(at + kDatedLedgerEntrySize + 32 * p + 24, "a pilot's sum is not finite");
  }
  has_ledger_ = true;
}

void FileReader::read_end() {
  const std::string end = in_.read_end(kEndBodySize);
  const std::uint64_t start = in_.body_offset() - kMarkSize;
  totals_.photon_count = get<std::uint64_t>(&end[0]);
  std::memcpy(totals_.stored_flux.data(), &end[8], 24);
  std::memcpy(totals_.emitted_flux.data(), &end[32], 24);
  std::memcpy(totals_.escaped_flux.data(), &end[56], 24);
  std::memcpy(totals_.absorbed_flux.data(), &end[80], 24);
  if (totals_.photon_count != photon_count_)
    in_.bytes().fail(start + 4, "end block counts " + std::to_string(totals_.photon_count) + " photons, the file has " +
                                    std::to_string(photon_count_));
  if (totals_.stored_flux != stored_flux_.rounded())
    in_.bytes().fail(start + 12, "stored flux is not the sum of the photons' flux");
  check_flux(totals_.emitted_flux, start + 36, "emitted flux");
  check_flux(totals_.escaped_flux, start + 60, "escaped flux");
  check_flux(totals_.absorbed_flux, start + 84, "absorbed flux");
  if (is_overlay() && !has_ledger_) in_.bytes().fail(start, "an overlay without ledger", "make it again");
  if (has_tentative(header_) && !has_ledger_)
    in_.bytes().fail(start, "tentative photons without ledger", "make it again");
  if (has_ledger_) {
    PhotonTotals sums = totals_;
    add_up(ledger_, sums);
    if (sums != totals_) in_.bytes().fail(start + 36, "totals are not the sums of the ledger");
  }
  in_.bytes().expect_end();
  ended_ = true;
}

void FileReader::check_flux(const std::array<double, 3>& flux, std::uint64_t offset, const char* name) const {
  for (std::size_t c = 0; c < 3; ++c)
    if (!std::isfinite(flux[c]) || (flux[c] < 0 && !rules_.signed_flux))
      in_.bytes().fail(offset + 8 * c, std::string(name) + " is not finite or is negative");
}

}  // namespace tempolux::formats::photons
