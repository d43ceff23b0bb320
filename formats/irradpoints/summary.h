// formats/irradpoints/summary.h -- what is in a file of irradiance points, in figures: for people and for
// checks.
#pragma once

#include <array>

#include "formats/irradpoints/irradpoints.h"
#include "formats/record_statistics.h"

namespace tempolux::formats {

/// Figures of one kind of light.
struct IrradianceShare {
  std::array<Spread, 3> irradiance;  ///< W/m^2, by channel
  std::array<double, 3> flux{};      ///< W: what arrives at all surfaces, total times spacing^2
};

struct IrradpointsSummary {
  RecordCensus points;
  IrradianceShare direct, caustic, indirect;  ///< of a kind not in the file: of zeros
  Spread radius;                              ///< m: of points that have a density estimate
};

IrradpointsSummary summarise(const IrradpointsFile& file);

/// Irradiance is that of all kinds together.
RecordDifference compare(const IrradpointsFile& a, const IrradpointsFile& b);

}  // namespace tempolux::formats
