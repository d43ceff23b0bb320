#include "lib/render/choose_photons.h"

#include <algorithm>
#include <cmath>

#include "lib/render/pilot_photons.h"

namespace tempolux {
namespace {

constexpr std::uint64_t kPaths = 1 << 15;
constexpr double kPathsAPhoton = 70;
/// Then photons cost about what all other stages do: 16 times a quarter of a second.
constexpr double kMost = 16;

}  // namespace

ArrivalPilot pilot_arrivals(const RenderScene& scene, const std::string& kinds, std::uint64_t seed) {
  return {kPaths, pilot_photons(scene.tracer, scene.lights, kinds, kPaths, seed ^ 0x61727269766564ull).photons.size()};
}

std::uint64_t photon_paths(const ArrivalPilot& pilot, std::uint64_t usual) {
  const double times = double(pilot.paths) / (kPathsAPhoton * std::max(1.0, double(pilot.photons)));
  return usual << int(std::ceil(std::log2(std::clamp(times, 1.0, kMost))));
}

}  // namespace tempolux
