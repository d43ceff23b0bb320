#include "lib/render/choose_preview.h"

#include <algorithm>
#include <cmath>

#include "lib/gather/mesh_elements.h"
#include "lib/render/pilot_photons.h"

namespace tempolux {
namespace {

constexpr std::uint64_t kPaths = 1 << 15;  ///< light paths of the pilot
constexpr double kMostPaths = 16;          ///< largest number of paths, in multiples of the number of photons asked for

}  // namespace

PreviewPilot pilot_preview(const RenderScene& scene, const std::string& kinds, std::uint64_t seed) {
  const std::size_t photons =
      pilot_photons(scene.tracer, scene.lights, kinds, kPaths, seed ^ 0x61727269766564ull).photons.size();
  return {double(photons) / double(kPaths), surface_area(scene.tracer.frame())};
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
