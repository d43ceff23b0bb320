// lib/material/inside.h -- which solids of glass a ray is inside, and how much light they absorb.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <span>

#include "lib/material/dispersion.h"
#include "lib/scene/scene.h"

namespace tempolux {

/// True if the material is the boundary of a transparent solid (KHR_materials_volume).
inline bool is_solid_glass(const MaterialValues& m) { return m.transmission > 0 && !m.thin_walled; }

/// True if a path that passes the surface enters or leaves a solid of glass. Paths pass a plate (SurfacePoint::plate)
/// straight and are never inside.
inline bool bounds_solid(const MaterialValues& m, float plate) { return is_solid_glass(m) && !(plate > 0); }

/// Transmittance of `distance` m inside the solid: attenuation_color^(distance / attenuation_distance) (Beer and
/// Lambert, as in KHR_materials_volume). 1 for clear glass. Never NaN: a colour of 0 gives exactly 0.
inline Rgb transmittance(const MaterialValues& m, float distance) {
  if (!(m.attenuation_distance < INFINITY)) return Rgb(1.0f);
  const float lengths = std::min(distance / m.attenuation_distance, 1e30f);
  return {std::pow(m.attenuation_color.r, lengths), std::pow(m.attenuation_color.g, lengths),
          std::pow(m.attenuation_color.b, lengths)};
}

/// The solids that a path is inside. A path enters a solid by crossing a front, and leaves it by crossing a back.
/// Solids are identified by their materials; crossing a back of another material leaves the innermost solid. Only the
/// innermost solid absorbs. If more than kDeepest solids are nested, the outermost is forgotten.
/// A path may start inside a solid; the caller names the solid if it absorbs (SolidAround). If a path meets a back
/// without having entered a solid, the distance since its last hit counts as inside the back's solid. A path that
/// leaves the scene counts as outside of all solids, so an open solid does not absorb light that escapes.
class Inside {
 public:
  Inside() = default;
  /// `start`: material of the solid in which the path starts; kNone: outside.
  explicit Inside(std::uint32_t start) {
    if (start != kNone) enter(start);
  }
  bool any() const { return count_ > 0; }  ///< true if the path is inside a solid
  /// Transmittance [1] of the last `distance` m before a surface of material `met`. front: the path arrives at the
  /// surface's front.
  Rgb transmittance_to(std::span<const Material> materials, std::uint32_t met, bool front, float distance) const {
    if (count_ > 0) return transmittance(materials[within_[count_ - 1]], distance);
    return !front && is_solid_glass(materials[met]) ? transmittance(materials[met], distance) : Rgb(1.0f);
  }
  /// Transmittance [1] of `distance` m in the innermost solid; 1 outside of all solids.
  Rgb transmittance_over(std::span<const Material> materials, float distance) const {
    return count_ > 0 ? transmittance(materials[within_[count_ - 1]], distance) : Rgb(1.0f);
  }
  /// Product of n^2 over the solids that the path is inside. Camera paths carry L / n^2 and photons carry watts, so
  /// irradiance from photons must be divided by this factor. wavelength_nm: HeroWavelength::nm of the path.
  float index_squared(std::span<const Material> materials, float wavelength_nm = 0) const {
    float product = 1;
    for (int i = 0; i < count_; ++i) {
      const float index = index_at(materials[within_[i]], wavelength_nm);
      product *= index * index;
    }
    return product > 0 ? product : 1;
  }
  /// n^2 of the solid `met` if the path started inside `met` and reaches its boundary for the first time, else 1.
  /// Camera paths do not divide the radiance of a lamp inside a solid by n^2. To match them, a photon of the lamp
  /// carries n^2 times the watts from here on. front: the side that the path came from.
  float index_squared_of_start(std::span<const Material> materials, std::uint32_t met, bool front,
                               float wavelength_nm = 0) const {
    const float ior = index_at(materials[met], wavelength_nm);
    return !front && count_ == 0 && ior > 0 ? ior * ior : 1;
  }
  /// Updates the state after an event S at the boundary of a solid (is_solid_glass). front: the side that the path came
  /// from.
  void scatter(std::uint32_t material, bool front, bool transmitted) {
    if (transmitted) {
      if (front) enter(material);
      else leave(material);
    } else if (!front && count_ == 0) {
      enter(material);  // reflected inside the solid in which the path started
    }
  }
  /// Forgets the solid if the path is inside it.
  void forget(std::uint32_t material) {
    for (int i = count_; i-- > 0;)
      if (within_[i] == material) return leave(material);
  }

 private:
  static constexpr int kDeepest = 4;
  void enter(std::uint32_t material) {
    if (count_ == kDeepest) {
      for (int i = 1; i < count_; ++i) within_[i - 1] = within_[i];
      --count_;
    }
    within_[count_++] = material;
  }
  void leave(std::uint32_t material) {
    if (count_ == 0) return;
    int at = count_ - 1;
    while (at > 0 && within_[at] != material) --at;
    if (within_[at] != material) at = count_ - 1;
    for (--count_; at < count_; ++at) within_[at] = within_[at + 1];
  }

  std::uint32_t within_[kDeepest];  ///< the innermost is the last
  int count_ = 0;
};

}  // namespace tempolux
