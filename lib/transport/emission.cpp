#include "lib/transport/emission.h"

#include "lib/core/sampling.h"

namespace tempolux {

Rgb weighed_emission(const Lights& lights, const SurfacePoint& hit, Vec3 wo, const LastScatter& last, float width) {
  const Rgb emitted = lights.emitted(hit, wo, last.weighed ? 0 : width);
  if (is_black(emitted) || !last.weighed) return emitted;
  const float of_light =
      lights.pdf_solid_angle(last.position, last.normal, hit.surface, hit.triangle, hit.position, last.from);
  return emitted * mis_power(last.pdf_solid_angle, last.light_share * of_light);
}

Rgb weighed_environment(const Lights& lights, Vec3 direction, const LastScatter& last) {
  const EnvironmentLight::Place place = lights.environment_place(direction);
  const Rgb radiance = lights.environment_at(place);
  if (!last.weighed) return radiance;
  return radiance *
         mis_power(last.pdf_solid_angle,
                   last.light_share * lights.pdf_environment(last.position, last.normal, place, direction, last.from));
}

}  // namespace tempolux
