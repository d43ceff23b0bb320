// formats/radsamples/layout.h -- declarations and rules that the writer and the reader of radsamples.md share.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "formats/container.h"
#include "formats/exact_sum.h"
#include "formats/radsamples/radsamples.h"

namespace tempolux::formats::radsamples {

inline constexpr Format kFormat{{"\x89TRADS\r\n", 8}, ".radsamples", "gather-temporal", 1, 2};
inline constexpr std::uint16_t kBaseSince = 1, kHighSince = 2;  ///< minor versions
inline constexpr std::string_view kPointsMark = "RADP", kRecordsMark = "RADR", kSamplesMark = "RADS";
inline constexpr std::size_t kPointSize = 12, kSampleSize = 8, kAnchorSize = 4, kEndBodySize = 48;
inline constexpr std::uint32_t kNoAnchor = 0xffffffff;

std::string header_text(const RadsamplesHeader& h);
std::optional<HeaderError> parse_header_text(std::string_view text, std::uint16_t minor, bool allow_unknown,
                                             RadsamplesHeader& h);

/// Checks a record or a sample for both reader and writer: returns the fault, or "" if there is none. `anchor` is
/// kNoAnchor if the file does not have the column.
std::string_view fault_of(const RadsamplesRecord& r);
std::string_view fault_of(const RadianceSample& s, std::uint32_t anchor, std::size_t points);

/// True if the file itself holds the record's samples. Only in an overlay may a record take its samples from the
/// base.
bool is_own(const RadsamplesFile& file, std::size_t record);
/// Number of samples in the file itself.
std::uint64_t own_samples(const RadsamplesFile& file);

/// The values of the end block.
struct Totals {
  std::uint64_t points = 0, records = 0, samples = 0;
  std::array<double, 3> irradiance{};
};
Totals totals_of(const RadsamplesFile& file);

}  // namespace tempolux::formats::radsamples
