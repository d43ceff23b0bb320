// formats/irradpoints/layout.h -- declarations that the writer and the reader of irradpoints.md share.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "formats/container.h"
#include "formats/exact_sum.h"
#include "formats/irradpoints/irradpoints.h"

namespace tempolux::formats::irradpoints {

inline constexpr Format kFormat{{"\x89TIRPT\r\n", 8}, ".irradpoints", "irradcache-build points", 1, 2};
inline constexpr std::string_view kBlockMark = "IRPT";
inline constexpr std::size_t kPointSize = 24, kIrradianceSize = 12, kEndBodySize = 80;

/// A kind of light; kKinds lists the three kinds in the order of their columns.
struct Kind {
  std::string_view name;
  std::array<float, 3> IrradiancePointRecord::*irradiance;
  std::array<double, 3> IrradpointsTotals::*total;
};
inline constexpr std::array<Kind, 3> kKinds{
    {{"direct", &IrradiancePointRecord::direct, &IrradpointsTotals::direct},
     {"caustic", &IrradiancePointRecord::caustic, &IrradpointsTotals::caustic},
     {"indirect", &IrradiancePointRecord::indirect, &IrradpointsTotals::indirect}}};

/// Bit set of the kinds in a list such as "direct,indirect"; bit k stands for kKinds[k]. 0 if the text is no list of
/// kinds in this order.
unsigned kinds_of(std::string_view list);

/// Number of bytes of one point in a block with these kinds and columns. `kinds` and `columns` are sets of bits. The
/// sum counts `columns` as a number, which is right while noise is the only column: a second column needs its own term.
constexpr std::size_t point_size(unsigned kinds, std::uint32_t columns) {
  return kPointSize + kIrradianceSize * ((kinds & 1) + ((kinds >> 1) & 1) + ((kinds >> 2) & 1) + columns);
}

/// The format with the earliest minor version that has all keys of this header.
Format format_of(const IrradpointsHeader& header);

/// The text of the header. Throws std::invalid_argument if a value is out of range.
std::string header_text(const IrradpointsHeader& header);

/// Parses the text of a file of version 1.`minor`. Unknown keys are accepted if `minor` is later than this program's
/// version. Returns nothing if the header is valid.
std::optional<HeaderError> parse_header_text(std::string_view text, std::uint16_t minor, IrradpointsHeader& header);

/// The reason for refusing a point (irradpoints.md, section 3); "" if the point is valid. Reader and writer both call
/// it.
std::string_view fault_of(const IrradiancePointRecord& point, unsigned kinds, std::uint32_t columns);

/// Counts points and sums their irradiance by kind.
class PointSums {
 public:
  /// Adds a point, which must be valid.
  void add(const IrradiancePointRecord& point);
  IrradpointsTotals totals() const;

 private:
  std::uint64_t count_ = 0;
  std::array<ExactRgbSum, 3> sums_;
};

}  // namespace tempolux::formats::irradpoints
