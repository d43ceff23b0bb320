#include "formats/irradpoints/summary.h"

namespace tempolux::formats {
namespace {

IrradianceShare share_of(const IrradpointsFile& file, std::array<float, 3> IrradiancePointRecord::*irradiance,
                         const std::array<double, 3>& total) {
  IrradianceShare share;
  for (std::size_t c = 0; c < 3; ++c) {
    for (const IrradiancePointRecord& point : file.records) share.irradiance[c].add(double((point.*irradiance)[c]));
    share.flux[c] = total[c] * file.header.spacing * file.header.spacing;
  }
  return share;
}

}  // namespace

IrradpointsSummary summarise(const IrradpointsFile& file) {
  IrradpointsSummary summary;
  for (const IrradiancePointRecord& point : file.records) {
    summary.points.add(point, file.header.origin);
    if (point.radius > 0) summary.radius.add(double(point.radius));
  }
  summary.direct = share_of(file, &IrradiancePointRecord::direct, file.totals.direct);
  summary.caustic = share_of(file, &IrradiancePointRecord::caustic, file.totals.caustic);
  summary.indirect = share_of(file, &IrradiancePointRecord::indirect, file.totals.indirect);
  return summary;
}

}  // namespace tempolux::formats
