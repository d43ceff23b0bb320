// formats/irradpoints/layout.h -- numbers of irradpoints.md that its writer and its reader share.
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

/// One of the three kinds, in the order of their columns.
struct Kind {
  std::string_view name;
  std::array<float, 3> IrradiancePointRecord::*irradiance;
  std::array<double, 3> IrradpointsTotals::*total;
};
inline constexpr std::array<Kind, 3> kKinds{
    {{"direct", &IrradiancePointRecord::direct, &IrradpointsTotals::direct},
     {"caustic", &IrradiancePointRecord::caustic, &IrradpointsTotals::caustic},
     {"indirect", &IrradiancePointRecord::indirect, &IrradpointsTotals::indirect}}};

/// Bits of the kinds in a list "direct,indirect", bit k for kKinds[k]; 0 if it is not such a list in this
/// order.
unsigned kinds_of(std::string_view list);

/// Bytes of one point in a block with these kinds and columns.
constexpr std::size_t point_size(unsigned kinds, std::uint32_t columns) {
  return kPointSize + kIrradianceSize * ((kinds & 1) + ((kinds >> 1) & 1) + ((kinds >> 2) & 1) + columns);
}

/// The version a file with this header has: the oldest that knows its keys.
Format format_of(const IrradpointsHeader& header);

/// The text of a header. std::invalid_argument if a value is out of range.
std::string header_text(const IrradpointsHeader& header);

/// Parses the text of a file of version 1.minor; keys that we do not know pass if it is later than ours. Nothing if the
/// header is good.
std::optional<HeaderError> parse_header_text(std::string_view text, std::uint16_t minor, IrradpointsHeader& header);

/// Why a point is refused (irradpoints.md, section 3); "" if it is good. The predicate of the format.
std::string_view fault_of(const IrradiancePointRecord& point, unsigned kinds, std::uint32_t columns);

/// Counts points and adds their irradiance, kind by kind.
class PointSums {
 public:
  /// `point` must be good.
  void add(const IrradiancePointRecord& point);
  IrradpointsTotals totals() const;

 private:
  std::uint64_t count_ = 0;
  std::array<ExactRgbSum, 3> sums_;
};

}  // namespace tempolux::formats::irradpoints
