#include "lib/material/albedo.h"

#include <algorithm>
#include <cmath>

namespace tempolux {

AlbedoPair ggx_albedo(float cos_theta, float alpha) {
  const float roughness = std::sqrt(alpha);
  const float rx = 1 - roughness, ry = 0.0425f - 0.0275f * roughness, rz = 1.04f - 0.572f * roughness,
              rw = 0.022f * roughness - 0.04f;
  const float a004 = std::min(rx * rx, std::exp2(-9.28f * cos_theta)) * rx + ry;
  return {std::max(0.0f, -1.04f * a004 + rz), std::max(0.0f, 1.04f * a004 + rw)};
}

AlbedoPair ggx_mean_albedo(float alpha) {
  AlbedoPair sum;
  for (int i = 0; i < 8; ++i) {
    const float mu = (float(i) + 0.5f) / 8;
    const AlbedoPair e = ggx_albedo(mu, alpha);
    sum.a += e.a * mu / 4;
    sum.b += e.b * mu / 4;
  }
  return sum;
}

}  // namespace tempolux
