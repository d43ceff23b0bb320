#include "lib/temporal/ageing.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "formats/radsamples/sample.h"
#include "lib/core/random.h"

namespace tempolux {

/// Each cell gets an exponentially distributed time with its weight as rate; the cells with the earliest times have the
/// distribution of the draws [Efraimidis and Spirakis 2006].
void draw_by_age(std::span<const std::uint16_t> ages, std::size_t count, std::uint64_t key,
                 std::vector<std::uint32_t>& drawn) {
  thread_local std::vector<std::pair<double, std::uint32_t>> times;  // time, cell
  times.clear();
  std::size_t oldest = 0;
  for (std::uint32_t c = 0; c < ages.size(); ++c) {
    const double age = ages[c], u = unit_double(mix64(key + c * 0x9e3779b97f4a7c15ull));
    const bool is_oldest = ages[c] == formats::kMaxAge;
    oldest += is_oldest;
    times.push_back({is_oldest ? -1 : -std::log1p(-u) / (age * age), c});
  }
  count = std::min(std::max(count, oldest), times.size());
  std::partial_sort(times.begin(), times.begin() + std::ptrdiff_t(count), times.end());
  drawn.clear();
  for (std::size_t i = 0; i < count; ++i) drawn.push_back(times[i].second);
}

}  // namespace tempolux
