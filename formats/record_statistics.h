// formats/record_statistics.h -- numbers, bounds and means of records, for the summaries of several
// formats.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <map>

#include "formats/surface_set.h"

namespace tempolux::formats {

/// Smallest, largest and mean of the numbers added. min > max if there are none.
struct Spread {
  std::uint64_t count = 0;
  double min = std::numeric_limits<double>::infinity(), max = -std::numeric_limits<double>::infinity();
  double sum = 0;

  void add(double x) {
    ++count;
    min = std::min(min, x);
    max = std::max(max, x);
    sum += x;
  }
  /// Mean of the numbers; 0 if there are none.
  double mean() const { return count > 0 ? sum / double(count) : 0; }
};

/// Number of records by surface set and by object, and their bounds.
struct RecordCensus {
  std::uint64_t count = 0;
  std::array<std::uint64_t, 2> by_set{};             ///< by SurfaceSet
  std::map<std::uint16_t, std::uint64_t> by_object;  ///< by id.object; 65535: unknown
  std::array<Spread, 3> position;                    ///< m, world space, by axis

  template <class Record>
  void add(const Record& record, const std::array<double, 3>& origin) {
    ++count;
    ++by_set[std::size_t(record.set)];
    ++by_object[record.object];
    for (std::size_t c = 0; c < 3; ++c) position[c].add(origin[c] + double(record.position[c]));
  }
};

}  // namespace tempolux::formats
