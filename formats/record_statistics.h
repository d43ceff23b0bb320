// formats/record_statistics.h -- numbers, bounds, means and differences of records, for the summaries of several
// formats.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
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

/// Differences of two files, record by record in file order.
struct RecordDifference {
  std::uint64_t records = 0;    ///< number of compared records, as many as the shorter file has
  std::uint64_t differing = 0;  ///< compared records with any different field
  std::uint64_t first = 0;      ///< index of the first different record; only if differing > 0
  std::array<double, 3> largest_position{}, largest_irradiance{};  ///< m, W/m^2: |a - b| by axis, by channel

  /// Compares the next two records. `irradiance_of` gives the channels to compare.
  template <class Record, class Irradiance>
  void add(const Record& a, const Record& b, const Irradiance& irradiance_of) {
    const std::uint64_t index = records++;
    if (a == b) return;
    if (differing++ == 0) first = index;
    const auto in_a = irradiance_of(a), in_b = irradiance_of(b);
    for (std::size_t c = 0; c < 3; ++c) {
      largest_position[c] = std::max(largest_position[c], std::abs(double(a.position[c]) - double(b.position[c])));
      largest_irradiance[c] = std::max(largest_irradiance[c], std::abs(double(in_a[c]) - double(in_b[c])));
    }
  }
};

}  // namespace tempolux::formats
