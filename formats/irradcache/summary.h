// formats/irradcache/summary.h -- statistics of an irradiance cache, for people and for checks.
#pragma once

#include <array>

#include "formats/irradcache/irradcache.h"
#include "formats/record_statistics.h"

namespace tempolux::formats {

struct IrradcacheSummary {
  RecordCensus records;
  std::array<Spread, 3> irradiance;  ///< W/m^2, by channel
  Spread radius;                     ///< m: after clamping
  Spread radius_unclamped;           ///< m: over the records with a finite one
  Spread influence;                  ///< W/m^2; without values if the file does not have the column
};

IrradcacheSummary summarise(const IrradcacheFile& file);

}  // namespace tempolux::formats
