#include "lib/transport/direct_light.h"

namespace tempolux {

bool sample_direct(const Lights& lights, const Receiver& at, float u_choice, Vec2 u, DirectSample& sample) {
  const LightSample& light = sample.light;
  if (!lights.sample(at.place.position, at.shading, u_choice, u, sample.light)) return false;
  const float cosine = dot(light.wi, at.shading);
  if (!(cosine > 0 && dot(light.wi, at.geometric) > 0)) return false;
  sample.irradiance = light.facing_irradiance * (at.coat ? cosine * at.coat->arrival_weight(cosine) : cosine);
  sample.shadow = spawn_shadow_ray(at.place, light.position, light.position_offset);
  return true;
}

}  // namespace tempolux
