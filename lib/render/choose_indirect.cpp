#include "lib/render/choose_indirect.h"

#include <cstdio>
#include <vector>

#include "lib/core/parallel.h"
#include "lib/core/sobol.h"
#include "lib/render/places_seen.h"

namespace tempolux {
namespace {

constexpr int kPlaces = 2048, kPathsEach = 4, kLightsEach = 4;
constexpr double kLittle = 0.05;   ///< of the light
constexpr double kOpen = 0.35;     ///< of the rays: between rooms (0 to .15) and the open air (.4 and more)

std::string per_cent(double share) {
  char text[16];
  std::snprintf(text, sizeof text, "%.0f %%", 100 * share);
  return text;
}

double mean(const Layers& layers, Layer layer) { return double(channel_mean(layers[layer])); }

}  // namespace

IndirectPilot pilot_indirect(const RenderScene& scene, const CameraView& view, std::uint64_t seed) {
  struct Sums {
    double indirect = 0, all = 0, lamps = 0, lights = 0;
    int places = 0, open = 0;
  };
  const SeenPlaces seen = places_seen(scene, view, kPlaces, seed ^ 0x70696c6f74ull);
  std::vector<Sums> sums(kPlaces);
  parallel_chunks(kPlaces, 32, [&](std::size_t first, std::size_t last) {
    RayCounts counts;
    for (std::size_t i = first; i < last; ++i) {
      Sums& sum = sums[i];
      const Vec2 at = sobol_owen_2d(std::uint32_t(i), seed ^ 0x7061746873ull);
      const Ray ray = view.ray(at.x * float(view.width()), at.y * float(view.height()));
      for (std::uint32_t s = 0; s < kPathsEach; ++s) {
        const Layers layers = trace_eye_path(scene, ray, PixelRandom(seed ^ 0x70696c6f74ull, i, s), nullptr, counts, view.cone());
        sum.indirect += mean(layers, Layer::indirect);
        sum.all += mean(layers, Layer::direct) + mean(layers, Layer::caustic) + mean(layers, Layer::indirect);
      }
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
  for (const Sums& sum : sums) {
    all.indirect += sum.indirect;
    all.all += sum.all;
    all.lamps += sum.lamps;
    all.lights += sum.lights;
    all.places += sum.places;
    all.open += sum.open;
  }
  return {all.all > 0 ? all.indirect / all.all : 0, all.places > 0 ? double(all.open) / all.places : 0,
          all.lights > 0 ? all.lamps / all.lights : 1, all.places};
}

IndirectChoice choose_indirect(const IndirectPilot& pilot) {
  if (pilot.places == 0) return {IndirectMethod::paths, "no surface with a Lambert lobe is seen"};
  const std::string indirect = "indirect light is " + per_cent(pilot.indirect_share) + " of what surfaces scatter";
  const std::string open = per_cent(pilot.open_share) + " of the rays from what is seen leave the scene";
  if (pilot.indirect_share < kLittle) return {IndirectMethod::paths, indirect};
  if (pilot.open_share > kOpen) return {IndirectMethod::paths, open};
  const std::string lamps = per_cent(pilot.lamp_share) + " of the light comes from lamps";
  return {pilot.lamp_share < 0.5 ? IndirectMethod::gather : IndirectMethod::records, indirect + ", " + open + ", " + lamps};
}

}  // namespace tempolux
