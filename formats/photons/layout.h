// formats/photons/layout.h -- numbers of photons.md that its writer and its reader share.
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
inline constexpr std::uint32_t kMostPilots = 256;  ///< of a group
inline constexpr std::size_t kBlockHeadSize = 16, kLedgerEntrySize = 76, kDatedLedgerEntrySize = 88, kEndBodySize = 104;

/// Bytes of one photon in a block with these columns.
constexpr std::size_t photon_size(std::uint32_t columns) {
  return 32 + (columns & column_direction ? 4 : 0) + (columns & column_albedo ? 4 : 0);
}

/// The version a file with this header has: the oldest that knows its keys.
Format format_of(const PhotonHeader& header);
/// Has the map tentative photons? Then it is of version 1.3 and has a dated ledger.
bool has_tentative(const PhotonHeader& header);

/// The mark of the ledger that a file of this header has, and the size of its entries.
std::string_view ledger_mark(const PhotonHeader& header);
std::size_t ledger_entry_size(const PhotonHeader& header);

/// The text of a header. std::invalid_argument if a value is out of range.
std::string header_text(const PhotonHeader& header);

/// Parses the text of a file of version 1.minor; keys that we do not know pass if it is later than ours. Nothing if the
/// header is good.
std::optional<HeaderError> parse_header_text(std::string_view text, std::uint16_t minor, PhotonHeader& header);

/// What records of this file may hold.
struct RecordRules {
  std::uint32_t kinds = 31;  ///< bit k: PathKind k
  bool signed_flux = true;
};
/// The rules of a good header.
RecordRules rules_of(const PhotonHeader& header);

/// The first photon (or column entry) that breaks the rules of photons.md, sections 4 and 5.
struct RecordError {
  std::size_t index = 0;  ///< in its array
  std::string_view reason;
};
std::optional<RecordError> find_bad_photon(std::span<const Photon> photons, const RecordRules& rules);
std::optional<RecordError> find_bad_direction(std::span<const std::array<std::uint16_t, 2>> directions);

/// Exact sums of flux, one per channel.
struct FluxSum : ExactRgbSum {
  /// `photons` must have finite flux.
  void add(std::span<const Photon> photons);
};

/// Sets emitted, escaped and absorbed flux to the ledger's sums, added in its order.
void add_up(std::span<const GroupFlux> ledger, PhotonTotals& totals);

}  // namespace tempolux::formats::photons
