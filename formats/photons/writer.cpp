// formats/photons/writer.cpp -- writes .photons files and encodes blocks.
#include <algorithm>
#include <cmath>
#include <cstring>
#include <stdexcept>

#include "formats/photons/layout.h"

namespace tempolux::formats {
namespace {

using namespace photons;

void put_flux(std::string& bytes, const std::array<double, 3>& flux) {
  for (double x : flux) put(bytes, x);
}

[[noreturn]] void refuse(const std::string& reason) { throw std::invalid_argument("PhotonWriter: " + reason); }

/// Encodes the photons [first, first + count) of `block`, at most kMaxBlockCount, as one block.
void append_block(std::string& bytes, const PhotonBlock& block, std::uint32_t columns, std::size_t first,
                  std::size_t count) {
  const std::array<std::uint32_t, 2> words{block.group, std::uint32_t(count)};
  const std::size_t head = begin_block(bytes, kBlockMark, words);
  put_array(bytes, std::span(block.photons).subspan(first, count));
  if (columns & column_direction) put_array(bytes, std::span(block.directions).subspan(first, count));
  if (columns & column_albedo) put_array(bytes, std::span(block.albedos).subspan(first, count));
  seal_block(bytes, head, words.size());
}

}  // namespace

std::string encode_block(const PhotonBlock& block, std::uint32_t columns) {
  const std::size_t count = block.photons.size();
  if (block.directions.size() != (columns & column_direction ? count : 0) ||
      block.albedos.size() != (columns & column_albedo ? count : 0))
    throw std::invalid_argument("encode_block: a column has not one entry per photon");
  if (find_bad_direction(block.directions)) throw std::invalid_argument("encode_block: direction is above 65534");
  std::string bytes;
  bytes.reserve(count * photon_size(columns) + (count / kMaxBlockCount + 1) * kBlockHeadSize);
  std::size_t first = 0;
  do {
    const std::size_t size = std::min<std::size_t>(count - first, kMaxBlockCount);
    append_block(bytes, block, columns, first, size);
    first += size;
  } while (first < count);
  return bytes;
}

struct PhotonWriter::State {
  ContainerWriter out;
  PhotonHeader header;
  RecordRules rules;
  std::uint32_t last_group = 0;
  std::vector<std::uint32_t> groups;  ///< in an overlay: the groups that it holds
  std::uint64_t photon_count = 0;
  FluxSum stored_flux;

  State(ContainerWriter::Sink sink, const PhotonHeader& h)
      : out(std::move(sink), format_of(h), header_text(h)), header(h), rules(rules_of(h)) {}
  bool is_overlay() const { return !header.base_name.empty(); }
  /// Reads the checksums of the encoded blocks in `bytes`, which must be those of `block`.
  std::vector<std::uint32_t> checksums_of(std::string_view bytes, const PhotonBlock& block) const;
  void check_ledger(std::span<const GroupFlux> ledger) const;
  void check_totals(const PhotonTotals& totals) const;
  void write_ledger(std::span<const GroupFlux> ledger);
};

std::vector<std::uint32_t> PhotonWriter::State::checksums_of(std::string_view bytes, const PhotonBlock& block) const {
  std::vector<std::uint32_t> checksums;
  std::size_t photon_total = 0, at = 0;
  while (at < bytes.size()) {
    std::array<std::uint32_t, 4> head{};
    if (bytes.size() - at < kBlockHeadSize || bytes.substr(at, 4) != kBlockMark) refuse("these are not blocks");
    std::memcpy(head.data(), bytes.data() + at, kBlockHeadSize);
    if (head[1] != block.group) refuse("a block of another group was encoded");
    checksums.push_back(head[3]);
    photon_total += head[2];
    at += kBlockHeadSize + head[2] * photon_size(header.columns);
  }
  if (at != bytes.size() || photon_total != block.photons.size()) refuse("another block was encoded");
  return checksums;
}

void PhotonWriter::State::check_ledger(std::span<const GroupFlux> ledger) const {
  const std::size_t expected = is_overlay() ? groups.size() : header.group_count;
  if (ledger.size() != expected) refuse("the ledger does not have one entry per group");
  for (std::size_t i = 0; i < ledger.size(); ++i) {
    if (ledger[i].group != (is_overlay() ? groups[i] : i)) refuse("the ledger's groups are not those of the file");
    if (ledger[i].pilots.size() != header.pilots)
      refuse("a group of the ledger has another number of pilots than the header says");
    for (const PhotonPilot& pilot : ledger[i].pilots)
      if (!std::isfinite(pilot.sketch)) refuse("a pilot's sum is not finite");
  }
}

void PhotonWriter::State::check_totals(const PhotonTotals& totals) const {
  for (const auto& flux : {totals.emitted_flux, totals.escaped_flux, totals.absorbed_flux})
    for (double x : flux)
      if (!std::isfinite(x) || (x < 0 && !rules.signed_flux)) refuse("a total is not finite or is negative");
}

void PhotonWriter::State::write_ledger(std::span<const GroupFlux> ledger) {
  const bool dated = has_tentative(header);
  std::string body;
  for (const GroupFlux& group : ledger) {
    put(body, group.group);
    put_flux(body, group.emitted);
    put_flux(body, group.escaped);
    put_flux(body, group.absorbed);
    if (!dated) continue;
    put(body, group.frame);
    put(body, group.paths);
    put_array(body, std::span(group.pilots));
  }
  out.write_block(ledger_mark(header), {std::uint32_t(ledger.size())}, body);
}

PhotonWriter::PhotonWriter(std::function<void(const void*, std::size_t)> sink, const PhotonHeader& header)
    : state_(std::make_unique<State>(std::move(sink), header)) {}

PhotonWriter::~PhotonWriter() = default;

void PhotonWriter::write(const PhotonBlock& block) {
  write_encoded(encode_block(block, state_->header.columns), block);
}

void PhotonWriter::write_encoded(std::string_view bytes, const PhotonBlock& block) {
  State& s = *state_;
  if (s.out.finished()) refuse("a block after the end");
  if (block.group >= s.header.group_count || block.group < s.last_group)
    refuse("group " + std::to_string(block.group) + " is out of range or descends");
  if (block.photons.empty() && !s.is_overlay()) return;
  if (const auto bad = find_bad_photon(block.photons, s.rules))
    refuse("photon " + std::to_string(bad->index) + " of group " + std::to_string(block.group) + ": " +
           std::string(bad->reason));
  const std::vector<std::uint32_t> checksums = s.checksums_of(bytes, block);
  if (s.is_overlay() && (s.groups.empty() || s.groups.back() != block.group)) s.groups.push_back(block.group);
  s.last_group = block.group;
  s.photon_count += block.photons.size();
  s.stored_flux.add(block.photons);
  s.out.write_sealed(bytes, checksums);
}

PhotonTotals PhotonWriter::finish(const PhotonTotals& given, std::span<const GroupFlux> ledger) {
  State& s = *state_;
  if (s.out.finished()) refuse("finished twice");
  PhotonTotals totals = given;
  totals.photon_count = s.photon_count;
  totals.stored_flux = s.stored_flux.rounded();
  const bool has_ledger = !ledger.empty() || s.is_overlay() || has_tentative(s.header);
  if (has_ledger) {
    s.check_ledger(ledger);
    for (const GroupFlux& group : ledger) s.check_totals({0, {}, group.emitted, group.escaped, group.absorbed});
    add_up(ledger, totals);
  }
  s.check_totals(totals);
  if (has_ledger) s.write_ledger(ledger);
  std::string bytes;
  put(bytes, totals.photon_count);
  put_flux(bytes, totals.stored_flux);
  put_flux(bytes, totals.emitted_flux);
  put_flux(bytes, totals.escaped_flux);
  put_flux(bytes, totals.absorbed_flux);
  s.out.finish(bytes);
  return totals;
}

}  // namespace tempolux::formats
