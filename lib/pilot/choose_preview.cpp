#include "lib/pilot/choose_preview.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "lib/core/grid.h"
#include "lib/light_texture/mesh_elements.h"
#include "lib/pilot/pilot_photons.h"

namespace tempolux {
namespace {

/// Candidates for the number of photons below the Gaussian. From one to the next the Gaussian's width doubles.
constexpr std::array<double, 5> kKernels{64, 256, 1024, 4096, 16384};
constexpr std::size_t kWeights = kKernels.size() / 2;  ///< index of the candidate whose irradiance weighs errors

/// Luminance of the flux in each element: r of the first map, g of the second.
std::vector<Rgbd> flux_of(const Tracer& tracer, const std::array<std::span<const formats::Photon>, 2>& maps,
                          const MeshCuts& cuts, std::vector<formats::MeshElement>& elements) {
  std::vector<Rgbd> flux(elements.size(), Rgbd(0.0));
  for (int m = 0; m < 2; ++m) {
    double largest = 0;
    for (const formats::Photon& photon : maps[std::size_t(m)])
      for (const float f : photon.flux) largest = std::max(largest, double(f));
    if (!(largest > 0)) continue;
    MeshSums sums(tracer, cuts, largest * 0x1p-40);
    sums.add(maps[std::size_t(m)], {});
    put_sums(sums, elements);
    for (std::size_t i = 0; i < elements.size(); ++i) {
      const auto& e = elements[i].sums;
      flux[i][m] = sums.unit() * luminance(Rgbd(double(e[0]), double(e[1]), double(e[2])));
      elements[i].sums = {};
    }
  }
  return flux;
}

/// Squared error of each candidate plus a constant. flux: of flux_of(). smoothed: irradiance of both maps by candidate
/// and element.
std::array<double, kKernels.size()> errors_of(const std::vector<formats::MeshElement>& elements,
                                              const std::vector<Rgbd>& flux,
                                              const std::array<std::vector<Vec2>, kKernels.size()>& smoothed) {
  std::array<double, kKernels.size()> errors{};
  for (std::size_t i = 0; i < elements.size(); ++i) {
    const Vec2 weigh = smoothed[kWeights][i];
    const double mean = (double(weigh.x) + double(weigh.y)) / 2;
    if (!(mean > 0)) continue;
    for (std::size_t k = 0; k < errors.size(); ++k) {
      const double a = double(smoothed[k][i].x), b = double(smoothed[k][i].y);
      errors[k] += (double(elements[i].area) * (a * a + b * b) / 2 - a * flux[i].g - b * flux[i].r) / mean;
    }
  }
  return errors;
}

/// The number of photons with the least error, by a parabola through the best candidate and its two neighbours.
double least_of(const std::array<double, kKernels.size()>& errors) {
  const auto least = std::size_t(std::ranges::min_element(errors) - errors.begin());
  if (least == 0 || least + 1 == errors.size()) return kKernels[least];
  const double before = errors[least - 1] - errors[least], after = errors[least + 1] - errors[least];
  const double steps = before + after > 0 ? (before - after) / (before + after) / 2 : 0;
  return kKernels[least] * std::pow(kKernels[1] / kKernels[0], steps);
}

}  // namespace

double best_kernel(const Tracer& tracer, std::span<const formats::Photon> a, std::span<const formats::Photon> b) {
  const SceneFrame& frame = tracer.frame();
  const double area = surface_area(frame);
  if (!(area > 0) || a.empty() || b.empty()) return kKernels[1];
  const auto width_of = [&](double kernel) { return kernel_width(area, double(a.size() + b.size()) / 2, kernel); };
  const MeshCuts cuts(kCellOfWindows * width_of(kKernels[0]), {&frame});
  std::vector<formats::MeshElement> elements = all_elements(frame, cuts);
  const std::vector<Rgbd> flux = flux_of(tracer, {a, b}, cuts, elements);
  std::array<std::vector<Vec2>, kKernels.size()> smoothed;
  for (std::size_t k = 0; k < kKernels.size(); ++k) {
    smooth_elements(tracer, flux, {MeshFilter::Kind::gaussian, width_of(kKernels[k])}, {}, elements);
    for (const formats::MeshElement& e : elements) smoothed[k].push_back({e.irradiance[0], e.irradiance[1]});
  }
  return least_of(errors_of(elements, flux, smoothed));
}

double pilot_kernel(const RenderScene& scene, const std::string& kinds, std::uint64_t seed) {
  const auto map = [&](std::uint64_t of) {
    return pilot_photons(scene.tracer, scene.lights, kinds, kPilotPaths, seed ^ of).photons;
  };
  return best_kernel(scene.tracer, map(0x6b65726e656c31ull), map(0x6b65726e656c32ull));
}

PreviewPilot pilot_preview(const RenderScene& scene, const std::string& kinds, std::uint64_t seed) {
  const std::size_t photons =
      pilot_photons(scene.tracer, scene.lights, kinds, kPilotPaths, seed ^ 0x61727269766564ull).photons.size();
  return {double(photons) / double(kPilotPaths), surface_area(scene.tracer.frame())};
}

PreviewChoice choose_preview(std::span<const PreviewPilot> pilots, double kernel, std::uint64_t photons, int frames) {
  PreviewPilot mean;
  for (const PreviewPilot& pilot : pilots) {
    mean.photons += pilot.photons / double(pilots.size());
    mean.area += pilot.area / double(pilots.size());
  }
  const double more = mean.photons > 0 ? nearest_on_grid(std::clamp(1 / mean.photons, 1.0, kMostTimesPhotons), 4) : 1;
  const auto paths = std::uint64_t(std::llround(double(photons) * more));
  // The density of N photons, filtered by a Gaussian of deviation s, has the squared error v / (N s^2) + b s^2: noise
  // plus bias. The error is least at s^4 = v / (b N). The number of photons below the Gaussian, N s^2, then grows as
  // sqrt(N).
  const double growth = std::sqrt(double(paths) * frames / double(kPilotPaths));
  const double width = kernel_width(mean.area, mean.photons * double(paths) * frames, kernel * growth);
  return {paths, width > 0 ? nearest_on_grid(width, 4) : width};
}

}  // namespace tempolux
