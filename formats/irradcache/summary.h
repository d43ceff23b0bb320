// formats/irradcache/summary.h -- what is in an irradiance cache, in figures: for people and for checks.
#pragma once

#include <array>

#include "formats/irradcache/irradcache.h"
#include "formats/record_statistics.h"

namespace tempolux::formats {

struct IrradcacheSummary {
  RecordCensus records;
  std::array<Spread, 3> irradiance;  ///< W/m^2, by channel
  Spread radius;                     ///< m: after clamping
  Spread radius_unclamped;           ///< m: of the records where it is finite
  Spread influence;                  ///< W/m^2; none without the column
};

IrradcacheSummary summarise(const IrradcacheFile& file);

RecordDifference compare(const IrradcacheFile& a, const IrradcacheFile& b);

}  // namespace tempolux::formats
