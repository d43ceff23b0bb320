#include "lib/material/diffuse_transmission.h"

namespace tempolux {

SideChoice choose_side(const Bsdf& bsdf, Vec3 direction, const MaterialValues& material, float u) {
  const Vec3 wo = direction.z > 0 ? direction : Vec3{0, 0, 1};
  const float own = channel_mean(bsdf.specular_albedo(wo) + bsdf.diffuse_reflectance(wo)) +
                    material.transmission * (1 - material.metallic),
              other = channel_mean(Bsdf(on_far_side(material)).diffuse_reflectance(wo));
  const float far = own + other > 0 ? other / (own + other) : 0;
  return u < far ? SideChoice{true, far} : SideChoice{false, 1 - far};
}

}  // namespace tempolux
