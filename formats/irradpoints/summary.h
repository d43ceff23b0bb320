// formats/irradpoints/summary.h -- statistics of a file of irradiance points, for people and for checks.
#pragma once

#include <array>

#include "formats/irradpoints/irradpoints.h"
#include "formats/record_statistics.h"

namespace tempolux::formats {

/// Statistics of one kind of light.
struct IrradianceShare {
  std::array<Spread, 3> irradiance;  ///< W/m^2, by channel
  std::array<double, 3> flux{};      ///< W: flux that arrives at all surfaces, total times spacing^2
};

struct IrradpointsSummary {
  RecordCensus points;
  IrradianceShare direct, caustic, indirect;  ///< zeros for a kind that the file does not have
  Spread radius;                              ///< m: over the points with a density estimate
};

IrradpointsSummary summarise(const IrradpointsFile& file);

}  // namespace tempolux::formats
