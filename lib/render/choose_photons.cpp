#include "lib/render/choose_photons.h"

#include <algorithm>
#include <cmath>

namespace tempolux {
namespace {

constexpr double kPathsAPhoton = 70;
/// With this many times the usual photons, photons cost about as much as all other stages: 16 x .25 s.
constexpr double kMost = 16;

}  // namespace

std::uint64_t photon_paths(double photons_per_path, std::uint64_t usual) {
  const double times = photons_per_path > 0 ? 1 / (kPathsAPhoton * photons_per_path) : kMost;
  return usual << int(std::ceil(std::log2(std::clamp(times, 1.0, kMost))));
}

}  // namespace tempolux
