// formats/photons/file_reader.h -- reads one .photons file alone; an overlay is not joined with its base.
#pragma once

#include "formats/container.h"
#include "formats/photons/layout.h"

namespace tempolux::formats::photons {

class FileReader {
 public:
  /// Opens the file and reads the header.
  explicit FileReader(const std::string& path);

  const PhotonHeader& header() const { return header_; }
  bool is_overlay() const { return !header_.base_name.empty(); }
  /// Reads the next block, which may be empty. Returns false after the ledger and the end block were read and
  /// checked.
  bool read_block(PhotonBlock& block);
  /// Totals and ledger; valid after the last block.
  const PhotonTotals& totals() const { return totals_; }
  const std::vector<GroupFlux>& ledger() const { return ledger_; }
  std::uint64_t photon_count_bound() const { return in_.bytes().size() / photon_size(header_.columns); }
  /// Throws InputError with the present offset.
  [[noreturn]] void fail(const std::string& reason, const std::string& remedy) const {
    in_.bytes().fail(in_.bytes().offset(), reason, remedy);
  }

 private:
  void read_body(PhotonBlock& block, std::size_t count);
  void check_body(const PhotonBlock& block, std::uint64_t start) const;
  void read_ledger();
  void read_end();
  void check_flux(const std::array<double, 3>& flux, std::uint64_t offset, const char* name) const;

  ContainerReader in_;
  PhotonHeader header_;
  RecordRules rules_;
  std::uint32_t last_group_ = 0;
  std::vector<std::uint32_t> groups_;  ///< in an overlay: the groups with a block
  std::uint64_t photon_count_ = 0;
  FluxSum stored_flux_;
  PhotonTotals totals_;
  std::vector<GroupFlux> ledger_;
  bool has_ledger_ = false, ended_ = false;
};

}  // namespace tempolux::formats::photons
