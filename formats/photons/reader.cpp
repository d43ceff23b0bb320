// formats/photons/reader.cpp -- reads photon maps: joins an overlay with its base, computes the digest, loads whole
// maps.
#include <algorithm>
#include <functional>
#include <stdexcept>

#include "formats/base_file.h"
#include "formats/hash.h"
#include "formats/large_pages.h"
#include "formats/photons/file_reader.h"

namespace tempolux::formats {
namespace {

using namespace photons;

/// Computes the digest of photons.md, section 9.
class Digest {
 public:
  void add(const PhotonBlock& block) {
    if (block.photons.empty()) return;
    if (block.group != group_) end_group();
    group_ = block.group;
    count_ += block.photons.size();
    add_to(records_, block.photons);
    add_to(directions_, block.directions);
    add_to(albedos_, block.albedos);
  }

  std::string hex(const PhotonHeader& header) {
    end_group();
    const auto column = [&](PhotonColumns bit, const Hasher& hash) {
      return header.columns & bit ? std::string("#").append(hash.hex()) : std::string("none");
    };
    return hash_hex("photons: 1\nmap: " + header.map + "\norigin: " + hex_of(header.origin) +
                    "\ngroups: " + std::to_string(header.group_count) + " #" + groups_.hex() + "\nrecords: #" +
                    records_.hex() + "\ndirection: " + column(column_direction, directions_) +
                    "\nalbedo: " + column(column_albedo, albedos_) + "\n");
  }

 private:
  template <class T>
  static void add_to(Hasher& hash, const std::vector<T>& values) {
    hash.add_bytes(values.data(), values.size() * sizeof(T));
  }
  void end_group() {
    if (count_ == 0) return;
    groups_.add(group_);
    groups_.add(count_);
    count_ = 0;
  }

  Hasher groups_, records_, directions_, albedos_;
  std::uint32_t group_ = 0;
  std::uint64_t count_ = 0;
};

/// Joins the ledgers of an overlay and its base, by ascending group. The overlay's entry replaces the base's.
std::vector<GroupFlux> merge_ledgers(const std::vector<GroupFlux>& overlay, const std::vector<GroupFlux>& base) {
  std::vector<GroupFlux> merged;
  std::set_union(overlay.begin(), overlay.end(), base.begin(), base.end(), std::back_inserter(merged),
                 [](const GroupFlux& a, const GroupFlux& b) { return a.group < b.group; });
  return merged;
}

}  // namespace

struct PhotonReader::State {
  FileReader file;
  std::unique_ptr<FileReader> base;  ///< of an overlay; else null
  std::optional<Digest> digest, base_digest;
  PhotonBlock next, next_base;  ///< for an overlay: the next block of overlay and base that was not yet delivered
  bool has_next = false, has_next_base = false;
  std::int64_t last_replaced = -1;  ///< the last group that the overlay holds, of those read so far
  PhotonTotals totals;
  std::vector<GroupFlux> ledger;
  FluxSum stored_flux;  ///< for an overlay: over the whole map
  bool ended = false;

  State(const std::string& path, const PhotonReadOptions& options) : file(path) {
    if (options.digest) digest.emplace();
    if (file.is_overlay()) open_base(path);
  }
  void open_base(const std::string& path);
  bool read_merged(PhotonBlock& block);
  bool advance_base();
  void end_merged();
};

void PhotonReader::State::open_base(const std::string& path) {
  base = std::make_unique<FileReader>(path_of_base(path, file.header().base_name));
  if (base->is_overlay()) file.fail("its base is an overlay itself", "make it again upon a whole map");
  const PhotonHeader &a = file.header(), &b = base->header();
  if (a.map != b.map || rules_of(a).kinds != rules_of(b).kinds || a.columns != b.columns ||
      a.majorants != b.majorants || a.pilots != b.pilots || a.origin != b.origin || a.group_count != b.group_count)
    file.fail("its base " + a.base_name + " has another map, kinds, columns, origin or groups", "make it again");
  base_digest.emplace();
  has_next = file.read_block(next);
  has_next_base = advance_base();
}

bool PhotonReader::State::advance_base() {
  if (!base->read_block(next_base)) return false;
  base_digest->add(next_base);
  return true;
}

/// Delivers the block of the lower group. If both files have the group, the overlay's block replaces the base's.
bool PhotonReader::State::read_merged(PhotonBlock& block) {
  while (has_next || has_next_base) {
    if (has_next && (!has_next_base || next.group <= next_base.group)) {
      std::swap(block, next);
      last_replaced = block.group;
      has_next = file.read_block(next);
      return true;
    }
    const bool replaced = std::int64_t(next_base.group) == last_replaced;
    if (!replaced) std::swap(block, next_base);
    has_next_base = advance_base();
    if (!replaced) return true;
  }
  end_merged();
  return false;
}

void PhotonReader::State::end_merged() {
  const std::string& name = file.header().base_name;
  if (base_digest->hex(base->header()) != file.header().base_digest)
    file.fail("its base " + name + " has another digest than when the overlay was written",
              "restore that file or make the overlay again");
  if (base->ledger().empty()) file.fail("its base " + name + " has no ledger", "make both again");
  ledger = merge_ledgers(file.ledger(), base->ledger());
  totals.stored_flux = stored_flux.rounded();
  add_up(ledger, totals);
}

PhotonReader::PhotonReader(const std::string& path, const PhotonReadOptions& options)
    : state_(std::make_unique<State>(path, options)) {}
PhotonReader::~PhotonReader() = default;

const PhotonHeader& PhotonReader::header() const { return state_->file.header(); }

bool PhotonReader::read_block(PhotonBlock& block) {
  State& s = *state_;
  while (!s.ended) {
    const bool more = s.base ? s.read_merged(block) : s.file.read_block(block);
    if (!more) {
      if (!s.base) s.totals = s.file.totals(), s.ledger = s.file.ledger();
      s.ended = true;
    } else if (!block.photons.empty()) {
      if (s.digest) s.digest->add(block);
      if (s.base) {
        s.totals.photon_count += block.photons.size();
        s.stored_flux.add(block.photons);
      }
      return true;
    }
  }
  block = {};
  return false;
}

const PhotonTotals& PhotonReader::totals() const {
  if (!state_->ended) throw std::logic_error("PhotonReader: totals before the end");
  return state_->totals;
}

const std::vector<GroupFlux>& PhotonReader::ledger() const {
  if (!state_->ended) throw std::logic_error("PhotonReader: ledger before the end");
  return state_->ledger;
}

std::string PhotonReader::digest() const {
  if (!state_->ended || !state_->digest) throw std::logic_error("PhotonReader: digest before the end or not asked for");
  return state_->digest->hex(header());
}

std::uint64_t PhotonReader::photon_count_bound() const {
  return state_->file.photon_count_bound() + (state_->base ? state_->base->photon_count_bound() : 0);
}

PhotonMap load_photons(const std::string& path) {
  PhotonReader reader(path, {.digest = false});
  PhotonMap map;
  map.header = reader.header();
  map.photons.reserve(reader.photon_count_bound());
  prefer_large_pages(map.photons.data(), map.photons.capacity() * sizeof(Photon));
  PhotonBlock block;
  if (map.header.columns & column_direction) map.directions.reserve(reader.photon_count_bound());
  while (reader.read_block(block)) {
    map.photons.insert(map.photons.end(), block.photons.begin(), block.photons.end());
    map.directions.insert(map.directions.end(), block.directions.begin(), block.directions.end());
  }
  map.totals = reader.totals();
  return map;
}

PhotonMap load_photons(const std::string& path, const std::function<bool(const PhotonHeader&, const Photon&)>& keep) {
  PhotonReader reader(path, {.digest = false});
  PhotonMap map;
  map.header = reader.header();
  PhotonBlock block;
  while (reader.read_block(block))
    for (std::size_t i = 0; i < block.photons.size(); ++i) {
      if (!keep(map.header, block.photons[i])) continue;
      map.photons.push_back(block.photons[i]);
      if (!block.directions.empty()) map.directions.push_back(block.directions[i]);
    }
  map.totals = reader.totals();
  return map;
}

}  // namespace tempolux::formats
