#include "lib/transport/direct_light.h"

namespace tempolux {

namespace {

/// Sets irradiance and shadow ray of a sample from its light. False if the light comes from behind the receiver.
bool arrives(const Receiver& at, DirectSample& sample) {
  const LightSample& light = sample.light;
  const float cosine = dot(light.wi, at.shading);
  if (!(cosine > 0 && dot(light.wi, at.geometric) > 0)) return false;
  sample.irradiance =
      light.facing_irradiance * (at.coat ? cosine * at.coat->arrival_weight(light.wi, at.shading) : cosine);
  sample.shadow = spawn_shadow_ray(at.place, light.position, light.position_offset);
  return true;
}

}  // namespace

bool sample_direct(const Lights& lights, const Receiver& at, float u_choice, Vec2 u, DirectSample& sample) {
  return lights.sample(at.place.position, at.shading, u_choice, u, sample.light) && arrives(at, sample);
}

bool sample_other_than_suns(const Lights& lights, const Receiver& at, Vec2 u, DirectSample& sample) {
  return lights.sample(at.place.position, at.shading, u, sample.light, Lights::From::not_suns) && arrives(at, sample);
}

bool sample_sun(const Lights& lights, const Receiver& at, Vec2 u, DirectSample& sample) {
  return lights.sample_sun(at.place.position, at.shading, u, sample.light) && arrives(at, sample);
}

}  // namespace tempolux
