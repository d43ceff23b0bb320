// lib/render/matte_ends.cpp -- samples of lights at matte ends of eye paths, eight at a time.
#include "lib/render/matte_ends.h"

#include <algorithm>
#include <array>

#include "lib/core/check.h"
#include "lib/gather/medium_event.h"

namespace tempolux {
namespace {

constexpr std::size_t kTogether = Lights::kTogether;

/// One sample of the lights at an end.
struct Sampling {
  MatteEnd* end;
  const Lights::Apart* at;
  std::uint32_t number;   ///< of the pixel's sample
};

/// Takes from the radiance what is lost on the way from the light: all where something is between; what media scatter or absorb.
/// False if nothing is left. `way`: tells the samples of large lights from those of the rest.
bool reaches(const RenderScene& scene, const MatteEnd& end, const LightSample& light, const PixelRandom& random, std::uint32_t way,
             Rgb& radiance, RayCounts& counts) {
  if (!end.sees(light.wi)) return false;
  ++counts.shadow;
  const Ray shadow = spawn_shadow_ray(end.surface, light.position, light.position_offset);
  if (scene.tracer.occluded(shadow)) return false;
  if (const Media* const media = scene.frame().media.get()) [[unlikely]]
    radiance *= media_transmittance(*media, shadow, {random.hashed(), end.bounce, way});
  return true;
}

Rgb arriving(const MatteEnd& end, const LightSample& light) {
  return end.reflected * light.radiance * std::max(0.0f, dot(light.wi, end.normal));
}

void add_large(const RenderScene& scene, MatteEnd& end, const LightSample& light, const PixelRandom& random, RayCounts& counts) {
  Rgb radiance = arriving(end, light);
  (end.layer == Layer::direct ? end.control.direct : end.control.specular) += radiance;
  end.control.sampled += channel_mean(radiance);
  if (is_black(radiance) || !reaches(scene, end, light, random, way_shadow, radiance, counts)) return;
  end.control.seen += channel_mean(radiance);
  end.light += radiance;
}

void add_rest(const RenderScene& scene, MatteEnd& end, const LightSample& light, const PixelRandom& random, RayCounts& counts) {
  Rgb radiance = arriving(end, light);
  if (!is_black(radiance) && reaches(scene, end, light, random, way_shadow_of_rest, radiance, counts)) end.light += radiance;
}

void take(const RenderScene& scene, const PixelRandom& random, std::span<const Sampling> samplings, RayCounts& counts) {
  thread_local std::array<LightSample, kTogether> large, rest;
  const Lights::Apart* at[kTogether];
  Vec2 u[kTogether];
  for (std::size_t i = 0; i < samplings.size(); ++i) {
    at[i] = samplings[i].at;
    u[i] = random.of_sample(samplings[i].number).get2(samplings[i].end->bounce, Purpose::light_point);
  }
  const unsigned found = scene.lights.sample_large({at, samplings.size()}, {u, samplings.size()}, large.data());
  unsigned rest_found = 0;
  for (std::size_t i = 0; i < samplings.size(); ++i) {
    const Vec2 choice = random.of_sample(samplings[i].number).get2(samplings[i].end->bounce, Purpose::light_choice);
    rest_found |= unsigned(scene.lights.sample_rest(*at[i], choice, rest[i])) << i;
  }
  for (std::size_t i = 0; i < samplings.size(); ++i) {
    const PixelRandom of_sample = random.of_sample(samplings[i].number);
    if (found >> i & 1) add_large(scene, *samplings[i].end, large[i], of_sample, counts);
    if (rest_found >> i & 1) add_rest(scene, *samplings[i].end, rest[i], of_sample, counts);
  }
}

}  // namespace

void sample_controlled_lights(const RenderScene& scene, std::span<MatteEnd> ends, const PixelRandom& random, RayCounts& counts) {
  TEMPOLUX_CHECK(ends.size() <= kPathsTogether);
  thread_local std::array<Lights::Apart, kPathsTogether> at;   // neither is made anew for each pixel
  Sampling samplings[kTogether];
  std::size_t waiting = 0;
  for (std::size_t i = 0; i < ends.size(); ++i) {
    scene.lights.apart(ends[i].surface.position, ends[i].normal, at[i]);
    ends[i].light = Rgb(0.0f);
  }
  for (std::size_t i = 0; i < ends.size(); ++i)
    for (std::uint32_t k = 0; k < ends[i].count; ++k) {
      samplings[waiting++] = {&ends[i], &at[i], ends[i].first + k};
      if (waiting < kTogether) continue;
      take(scene, random, samplings, counts);
      waiting = 0;
    }
  if (waiting > 0) take(scene, random, {samplings, waiting}, counts);
  for (std::size_t i = 0; i < ends.size(); ++i) {
    MatteEnd& end = ends[i];
    const auto n = float(end.count);
    (end.layer == Layer::direct ? end.control.direct : end.control.specular) += end.reflected * at[i].irradiance * -n;
    if (end.count > 1) end.light *= 1 / n;
  }
}

}  // namespace tempolux
