#include "lib/pilot/rough_light.h"

#include <algorithm>
#include <cmath>

#include "lib/pilot/pilot_photons.h"

namespace tempolux {
namespace {

/// Number of irradiance points on the front sides of all surfaces, and as many on the back sides.
/// docs/notebook/constants.md compares it with other numbers.
constexpr std::uint32_t kPoints = 500;

}  // namespace

RoughLight::RoughLight(const RenderScene& scene, const formats::PhotonBlock& photons, std::uint64_t paths,
                       std::uint64_t seed, std::span<const AimSphere> seen) {
  PointOptions placing;
  placing.seed = seed;
  placing.count = kPoints;
  placing.seen.assign(seen.begin(), seen.end());
  placed_ = place_points(scene.frame(), placing);
  estimate_points(scene.tracer, scene.lights, photons, {}, placing, placed_.points);
  const double narrower = std::sqrt(double(kPilotPaths) / double(std::max(kPilotPaths, paths)));
  for (IrradiancePoint& point : placed_.points) point.radius *= float(narrower);
  lookup_.emplace(placed_.points, placed_.spacing, point_clearance(scene.tracer));
  lookup_->take_as_even();
  lamps_ = note_lamps_beside(scene.tracer, scene.lights, *lookup_);
  const BrightOptions bright{.seed = seed, .beside_lamps = lamps_};
  if (!lamps_.empty()) bright_.emplace(scene.tracer, scene.lights, *lookup_, std::vector<float>{}, bright);
}

KnownLight RoughLight::known() const {
  KnownLight known;
  known.points = &*lookup_;
  return known;
}

GatherOptions RoughLight::gathering(std::uint64_t seed) const {
  GatherOptions options;
  options.seed = seed;
  options.rays = kRays;
  options.bright = bright_ ? &*bright_ : nullptr;
  return options;
}

}  // namespace tempolux
