#include "formats/photons/summary.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace tempolux::formats {
namespace {

void add(PhotonShare& share, const Photon& photon) {
  ++share.count;
  for (std::size_t c = 0; c < 3; ++c) share.flux[c] += double(photon.flux[c]);
}

}  // namespace

PhotonSummary summarise(PhotonReader& reader) {
  PhotonSummary summary;
  summary.bounds_min.fill(std::numeric_limits<double>::infinity());
  summary.bounds_max.fill(-std::numeric_limits<double>::infinity());
  const std::array<double, 3> origin = reader.header().origin;
  PhotonBlock block;
  while (reader.read_block(block)) {
    for (const Photon& photon : block.photons) {
      add(summary.all, photon);
      add(summary.by_kind[std::size_t(photon.kind)], photon);
      add(summary.by_object[photon.object], photon);
      summary.largest_bounce = std::max<std::uint64_t>(summary.largest_bounce, photon.bounce);
      for (std::size_t c = 0; c < 3; ++c) {
        const double x = origin[c] + double(photon.position[c]);
        summary.bounds_min[c] = std::min(summary.bounds_min[c], x);
        summary.bounds_max[c] = std::max(summary.bounds_max[c], x);
        summary.largest_flux = std::max(summary.largest_flux, std::abs(double(photon.flux[c])));
      }
    }
  }
  if (summary.all.count > 0)
    for (std::size_t c = 0; c < 3; ++c) summary.mean_flux[c] = summary.all.flux[c] / double(summary.all.count);
  return summary;
}

}  // namespace tempolux::formats
