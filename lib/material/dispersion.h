// lib/material/dispersion.h -- glass whose index depends on the wavelength (KHR_materials_dispersion), and the one
// wavelength that a path carries through it.
#pragma once

#include <algorithm>
#include <optional>

#include "lib/core/random.h"
#include "lib/scene/scene.h"

namespace tempolux {

/// True if the material refracts light of different wavelengths into different directions: a solid with dispersion.
inline bool disperses(const MaterialValues& m) { return m.dispersion > 0 && m.transmission > 0 && !m.thin_walled; }

/// Index of refraction at a wavelength [nm]; 0: the d line, 587.6 nm, for which files state the index. Cauchy's formula
/// in the form of KHR_materials_dispersion, where V = 20 / dispersion is the Abbe number:
///     n = max(1, n_d + (n_d - 1) / V (523655 / wavelength^2 - 1.5168)).
inline float index_at(const MaterialValues& m, float wavelength_nm) {
  if (!(wavelength_nm > 0 && m.ior > 1 && disperses(m))) return m.ior;
  const float steepness = (m.ior - 1) * (m.dispersion / 20);
  return std::max(1.0f, m.ior + steepness * (523655 / (wavelength_nm * wavelength_nm) - 1.5168f));
}

/// The wavelength of a path. A path carries light of all wavelengths until a solid with dispersion refracts the path
/// for the first time. From there to its end the path carries one wavelength, and its throughput is multiplied by
/// `color`. A path that the solid reflects goes on with all wavelengths.
struct HeroWavelength {
  float nm = 0;  ///< 0: none
  /// The colour, over the probability density: linear Rec. 709, at least 0. Its mean over u is 1 in each channel.
  Rgb color{1.0f};
};

/// Wavelength and colour for a random number in [0, 1), from a table that the build computes
/// (tables/spectrum_integrals.h). The three channels are the CIE 1931 curves in linear Rec. 709, with 0 in place of
/// negative values. A wavelength is drawn in proportion to their sum, so that colours differ in hue alone.
HeroWavelength hero_wavelength(float u);

/// The wavelength that a path takes if it is refracted at a surface: none without dispersion, at a plate that light
/// passes straight (SurfacePoint::plate), and if the path has a wavelength already. random: of the path (get1).
template <class Random>
std::optional<HeroWavelength> draw_wavelength(const MaterialValues& material, float plate, float wavelength_nm,
                                              const Random& random) {
  if (!(material.dispersion > 0)) [[likely]]
    return std::nullopt;
  if (!disperses(material) || plate > 0 || wavelength_nm > 0) return std::nullopt;
  return hero_wavelength(random.get1(0, Purpose::wavelength));
}

namespace spectrum_table {
inline constexpr int kSteps = 128;
extern const float kWavelength[kSteps + 1];  ///< nm, at equal steps of u
extern const float kColor[kSteps + 1][3];
}  // namespace spectrum_table

}  // namespace tempolux
