// formats/photons/layout.h -- declarations that the writer and the reader of photons.md share.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "formats/container.h"
#include "formats/exact_sum.h"
#include "formats/photons/photons.h"

namespace tempolux::formats::photons {

inline constexpr Format kFormat{{"\x89TPHOT\r\n", 8}, ".photons", "photon-trace", 1, 4};
inline constexpr std::uint32_t kMaxGroupCount = 1u << 24;
inline constexpr std::string_view kBlockMark = "PHOT", kLedgerMark = "LEDG", kDatedLedgerMark = "LEDU",
                                  kPilotLedgerMark = "LEDP";
inline constexpr std::uint32_t kMostPilots = 256;  ///< largest number of pilots in a group
inline constexpr std::size_t kBlockHeadSize = 16, kLedgerEntrySize = 76, kDatedLedgerEntrySize = 88, kEndBodySize = 104;

/// Number of bytes of one photon in a block with these columns.
constexpr std::size_t photon_size(std::uint32_t columns) {
  return 32 + (columns & column_direction ? 4 : 0) + (columns & column_albedo ? 4 : 0);
}

/// The format with the earliest minor version that has all keys of this header.
Format format_of(const PhotonHeader& header);
/// True if the map has tentative photons. The file then has version 1.3 and a ledger with frames.
bool has_tentative(const PhotonHeader& header);

/// The ledger's mark in a file with this header, and the size of the ledger's entries.
std::string_view ledger_mark(const PhotonHeader& header);
std::size_t ledger_entry_size(const PhotonHeader& header);

/// The text of the header. Throws std::invalid_argument if a value is out of range.
std::string header_text(const PhotonHeader& header);

/// Parses the text of a file of version 1.`minor`. Unknown keys are accepted if `minor` is later than this program's
/// version. Returns nothing if the header is valid.
std::optional<HeaderError> parse_header_text(std::string_view text, std::uint16_t minor, PhotonHeader& header);

/// The values that photons of a file may have.
struct RecordRules {
  std::uint32_t kinds = 31;  ///< bit k: PathKind k
  bool signed_flux = true;
};
/// The rules for the photons of a file with this valid header.
RecordRules rules_of(const PhotonHeader& header);

/// The first photon, or column entry, that breaks the rules of photons.md, sections 4 and 5.
struct RecordError {
  std::size_t index = 0;  ///< index in the array
  std::string_view reason;
};
std::optional<RecordError> find_bad_photon(std::span<const Photon> photons, const RecordRules& rules);
std::optional<RecordError> find_bad_direction(std::span<const std::array<std::uint16_t, 2>> directions);

/// Exact sums of flux, one per channel.
struct FluxSum : ExactRgbSum {
  /// Adds the flux of photons; it must be finite.
  void add(std::span<const Photon> photons);
};

/// Sets emitted, escaped and absorbed flux to the sums over the ledger, added in its order.
void add_up(std::span<const GroupFlux> ledger, PhotonTotals& totals);

}  // namespace tempolux::formats::photons
