#include "lib/render/choose_photons.h"

#include <algorithm>
#include <cmath>

namespace tempolux {
namespace {

constexpr double kPathsAPhoton = 70;  ///< derived in choose_photons.h

}  // namespace

std::uint64_t photon_paths(double photons_per_path, std::uint64_t usual) {
  const double times = photons_per_path > 0 ? 1 / (kPathsAPhoton * photons_per_path) : kMostTimesPhotons;
  return usual << int(std::ceil(std::log2(std::clamp(times, 1.0, kMostTimesPhotons))));
}

}  // namespace tempolux
