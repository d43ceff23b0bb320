#include "lib/render/choose_indirect.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <vector>

#include "lib/core/parallel.h"
#include "lib/core/sobol.h"
#include "lib/render/pixel_noise.h"
#include "lib/render/places_seen.h"

namespace tempolux {
namespace {

constexpr int kPlaces = 2048, kPathsEach = 4, kLightsEach = 4;

constexpr double kShare = 0.1;     ///< of the pixels' other squared error, that records may add
/// Squared error of records is this x a path's variance / rays: .052, .035, .036 in S2, S1, S4 (docs/pixels.md).
constexpr double kRaysPerPath = 0.04;

std::string per_cent(double share) {
  char text[16];
  std::snprintf(text, sizeof text, "%.0f %%", 100 * share);
  return text;
}

/// Of a pixel's error after as many samples as PixelNoise asks for, 4 at least: they are stratified.
double error_left(double variance, double samples) { return variance * std::pow(samples, -5.0 / 3); }
double samples_of(double variance, double level, double picture, double pixel_error) {
  return std::max(4.0, wanted_samples(std::sqrt(variance), 4, allowed_error(level, picture, pixel_error)));
}

/// Squared error of the indirect light of paths over that of all other light.
double indirect_noise(const IndirectPilot& pilot) {
  return pilot.other_noise > 0 ? pilot.indirect_variance / pilot.samples / pilot.other_noise : 0;
}

double mean(const Layers& layers, Layer layer) { return double(channel_mean(layers[layer])); }
double mean_of_all(const Layers& layers) {
  double sum = 0;
  for (const Rgb& layer : layers.value) sum += double(channel_mean(layer));
  return sum;
}

}  // namespace

IndirectPilot pilot_indirect(const RenderScene& scene, const CameraView& view, double pixel_error, std::uint64_t seed) {
  struct Sums {
    double indirect = 0, all = 0, lamps = 0, lights = 0;
    int places = 0, open = 0;
    double level = 0, indirect_variance = 0, other_variance = 0, caustic = 0, caustic_variance = 0, rest_variance = 0;
  };
  const SeenPlaces seen = places_seen(scene, view, kPlaces, seed ^ 0x70696c6f74ull);
  std::vector<Sums> sums(kPlaces);
  parallel_chunks(kPlaces, 32, [&](std::size_t first, std::size_t last) {
    RayCounts counts;
    for (std::size_t i = first; i < last; ++i) {
      Sums& sum = sums[i];
      const Vec2 at = sobol_owen_2d(std::uint32_t(i), seed ^ 0x7061746873ull);
      const float x = std::floor(at.x * float(view.width())), y = std::floor(at.y * float(view.height()));
      double others = 0, others2 = 0, indirect2 = 0, caustic2 = 0, rest = 0, rest2 = 0;
      for (std::uint32_t s = 0; s < kPathsEach; ++s) {
        const PixelRandom random(seed ^ 0x70696c6f74ull, i, s);
        const Vec2 in_pixel = random.get2(0, Purpose::pixel);
        const Layers layers = trace_eye_path(scene, view.ray(x + in_pixel.x, y + in_pixel.y), random, nullptr, counts, view.cone());
        sum.indirect += mean(layers, Layer::indirect);
        sum.all += mean(layers, Layer::direct) + mean(layers, Layer::caustic) + mean(layers, Layer::indirect);
        const double indirect = mean(layers, Layer::indirect), other = mean_of_all(layers) - indirect, caustic = mean(layers, Layer::caustic);
        sum.caustic += caustic;
        caustic2 += caustic * caustic;
        rest += other + indirect - caustic;
        rest2 += (other + indirect - caustic) * (other + indirect - caustic);
        indirect2 += indirect * indirect;
        others += other;
        others2 += other * other;
      }
      sum.level = (others + sum.indirect) / kPathsEach;
      sum.indirect_variance = sample_variance(kPathsEach, sum.indirect, indirect2);
      sum.other_variance = sample_variance(kPathsEach, others, others2);
      sum.caustic_variance = sample_variance(kPathsEach, sum.caustic, caustic2);
      sum.rest_variance = sample_variance(kPathsEach, rest, rest2);
      const SeenPlace& place = seen.places[i];
      if (!place.exists()) continue;
      sum.places = 1;
      sum.open = place.open;
      const PathRandom random(seed ^ 0x6c69676874ull, i);
      for (std::uint32_t s = 0; s < kLightsEach; ++s) {
        LightSample light;
        if (!scene.lights.sample(place.surface.position, place.normal, random.get2(s, Purpose::light_point), light) || !place.sees(light.wi) ||
            scene.tracer.occluded(spawn_shadow_ray(place.surface, light.position, light.position_offset)))
          continue;
        const double arriving = double(channel_mean(light.radiance) * dot(light.wi, place.normal));
        sum.lights += arriving;
        if (!light.distant) sum.lamps += arriving;
      }
    }
  });
  Sums all;
  for (const Sums& sum : sums) all.level += sum.level / kPlaces;
  IndirectPilot pilot;
  for (const Sums& sum : sums) {
    pilot.indirect_variance += sum.indirect_variance / kPlaces;
    const double others = samples_of(sum.other_variance, sum.level, all.level, pixel_error);
    pilot.other_error2 += error_left(sum.other_variance, others) / kPlaces;
    pilot.other_noise += sum.other_variance / others / kPlaces;
    const double samples = samples_of(sum.rest_variance, sum.level, all.level, pixel_error);
    pilot.rest_noise += sum.rest_variance / samples / kPlaces;
    pilot.samples += samples / kPlaces;
    pilot.caustic += sum.caustic / (kPlaces * kPathsEach);
    pilot.caustic_variance += sum.caustic_variance / kPlaces;
    all.indirect += sum.indirect;
    all.all += sum.all;
    all.lamps += sum.lamps;
    all.lights += sum.lights;
    all.places += sum.places;
    all.open += sum.open;
  }
  pilot.scattered = all.all / (kPlaces * kPathsEach);
  pilot.indirect_share = all.all > 0 ? all.indirect / all.all : 0;
  pilot.open_share = all.places > 0 ? double(all.open) / all.places : 0;
  pilot.lamp_share = all.lights > 0 ? all.lamps / all.lights : 1;
  pilot.places = all.places;
  pilot.paths = kPlaces * kPathsEach;
  return pilot;
}

int record_rays(const IndirectPilot& pilot, int most) {
  if (!(pilot.other_error2 > 0)) return most;
  const double rays = kRaysPerPath * pilot.indirect_variance / (kShare * pilot.other_error2);
  return std::clamp(int(std::min(rays, 1e6)), std::max(1, most / 10), most);
}

IndirectChoice choose_indirect(const IndirectPilot& pilot) {
  if (pilot.places == 0) return {IndirectMethod::paths, "no surface with a Lambert lobe is seen"};
  const std::string indirect = "indirect light is " + per_cent(pilot.indirect_share) + " of what surfaces scatter";
  const std::string open = per_cent(pilot.open_share) + " of the rays from what is seen leave the scene";
  if (pilot.indirect_share < kLittleIndirect) return {IndirectMethod::paths, indirect};
  if (pilot.open_share > kOpenScene) {
    if (pilot.lamp_share < 0.5) return {IndirectMethod::paths, open + ", " + per_cent(pilot.lamp_share) + " of the light comes from lamps"};
    const double noise = indirect_noise(pilot);
    const std::string of_error = "the noise of its paths is " + per_cent(noise) + " of that of all other light";
    return {noise > kIndirectPays ? IndirectMethod::gather : IndirectMethod::paths, indirect + ", " + of_error + ", " + open};
  }
  return {IndirectMethod::records, indirect + ", " + open};
}

}  // namespace tempolux
