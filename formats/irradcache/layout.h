// formats/irradcache/layout.h -- declarations that the writer and the reader of irradcache.md share.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "formats/container.h"
#include "formats/exact_sum.h"
#include "formats/irradcache/irradcache.h"

namespace tempolux::formats::irradcache {

inline constexpr Format kFormat{{"\x89TIRRC\r\n", 8}, ".irradcache", "irradcache-build", 1, 4};
inline constexpr std::string_view kBlockMark = "IRRC";
inline constexpr std::size_t kRecordSize = 120, kInfluenceSize = 4, kUpdateSize = 12, kClearanceSize = 20,
                             kNoiseSize = 12, kEndBodySize = 32;

/// Number of bytes of one record in a block with these columns.
constexpr std::size_t record_size(std::uint32_t columns) {
  return kRecordSize + (columns & column_influence ? kInfluenceSize : 0) + (columns & column_update ? kUpdateSize : 0) +
         (columns & column_clearance ? kClearanceSize : 0) + (columns & column_noise ? kNoiseSize : 0);
}

/// The format with the earliest minor version that has all keys of this header.
Format format_of(const IrradcacheHeader& header);

/// The text of the header. Throws std::invalid_argument if a value is out of range.
std::string header_text(const IrradcacheHeader& header);

/// Parses the text of a file of version 1.`minor`. Unknown keys are accepted if `minor` is later than this program's
/// version. Returns nothing if the header is valid.
std::optional<HeaderError> parse_header_text(std::string_view text, std::uint16_t minor, IrradcacheHeader& header);

/// The reason for refusing a record (irradcache.md, sections 3 and 4); "" if the record is valid. Reader and writer
/// both call it.
std::string_view fault_of(const IrradianceCacheRecord& record, std::uint32_t columns);

/// Counts records and sums their irradiance.
class RecordSums {
 public:
  /// Adds a record, which must be valid.
  void add(const IrradianceCacheRecord& record);
  IrradcacheTotals totals() const { return {count_, sum_.rounded()}; }

 private:
  std::uint64_t count_ = 0;
  ExactRgbSum sum_;
};

}  // namespace tempolux::formats::irradcache
