#include "lib/render/choose_preview.h"

#include <algorithm>
#include <cmath>

#include "lib/gather/mesh_elements.h"
#include "lib/render/choose_photons.h"

namespace tempolux {
namespace {

constexpr double kMostPaths = 16;            ///< of the photons asked for

}  // namespace

PreviewPilot pilot_preview(const RenderScene& scene, const std::string& kinds, std::uint64_t seed) {
  const ArrivalPilot pilot = pilot_arrivals(scene, kinds, seed);
  return {double(pilot.photons) / double(pilot.paths), surface_area(scene.tracer.frame())};
}

PreviewChoice choose_preview(std::span<const PreviewPilot> pilots, std::uint64_t photons, int frames) {
  PreviewPilot mean;
  for (const PreviewPilot& pilot : pilots) {
    mean.photons += pilot.photons / double(pilots.size());
    mean.area += pilot.area / double(pilots.size());
  }
  const double more = mean.photons > 0 ? std::clamp(1 / mean.photons, 1.0, kMostPaths) : 1;
  const auto paths = std::uint64_t(std::llround(double(photons) * more));
  return {paths, window_widths(mean.area, mean.photons * double(paths) * frames).filter.width};
}

}  // namespace tempolux
