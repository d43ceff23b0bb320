// lib/material/albedo.h -- directional albedo of the GGX lobe.
#pragma once

namespace tempolux {

/// E = F0 a + F90 b: what the lobe reflects of uniform light, with Fresnel's term of Schlick split in its two
/// linear parts. [1]
struct AlbedoPair {
  float a = 0, b = 0;
};

/// Of the single-scattering lobe of ggx.h towards cos_theta in (0, 1], alpha in (0, 1].
AlbedoPair ggx_albedo(float cos_theta, float alpha);
/// Cosine-weighted mean over the hemisphere, 2 integral of the above times cos d cos.
AlbedoPair ggx_mean_albedo(float alpha);

}  // namespace tempolux
