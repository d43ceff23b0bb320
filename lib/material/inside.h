// lib/material/inside.h -- which solids of glass a ray is inside of, and what they absorb on the way.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <span>

#include "lib/scene/scene.h"

namespace tempolux {

/// Is this the boundary of a solid that light passes through (KHR_materials_volume)?
inline bool is_solid_glass(const MaterialValues& m) { return m.transmission > 0 && !m.thin_walled; }

/// Share of light left after `distance` m inside the solid: attenuation_color^(distance / attenuation_distance)
/// (Beer and Lambert, as KHR_materials_volume has it). 1 for clear glass; 0 is exact, nothing is NaN.
inline Rgb transmittance(const MaterialValues& m, float distance) {
  if (!(m.attenuation_distance < INFINITY)) return Rgb(1.0f);
  const float lengths = std::min(distance / m.attenuation_distance, 1e30f);
  return {std::pow(m.attenuation_color.r, lengths), std::pow(m.attenuation_color.g, lengths),
          std::pow(m.attenuation_color.b, lengths)};
}

/// Followed along a path by the sides of the boundaries it meets. Going through a front enters the solid, going
/// through a back leaves it; solids nest kDeepest deep (the outermost is forgotten beyond), the innermost alone
/// absorbs. A path that starts inside knows it when it meets a back it never entered by: the way there was inside.
/// What meets nothing more is outside of all (an open solid absorbs nothing of what escapes). Solids are known by
/// their materials; going out through a back of another one leaves the innermost.
class Inside {
 public:
  bool any() const { return count_ > 0; }
  /// Light left on the way of `distance` m to a surface of material `met`, seen from its front or back.
  Rgb transmittance_to(std::span<const Material> materials, std::uint32_t met, bool front, float distance) const {
    if (count_ > 0) return transmittance(materials[within_[count_ - 1]], distance);
    return !front && is_solid_glass(materials[met]) ? transmittance(materials[met], distance) : Rgb(1.0f);
  }
  /// Light left after `distance` m in the innermost solid that the path is known to be inside of.
  Rgb transmittance_over(std::span<const Material> materials, float distance) const {
    return count_ > 0 ? transmittance(materials[within_[count_ - 1]], distance) : Rgb(1.0f);
  }
  /// Product of n^2 of the solids: what irradiance by watts is too high for radiance kept as L / n^2.
  float index_squared(std::span<const Material> materials) const {
    float product = 1;
    for (int i = 0; i < count_; ++i) product *= materials[within_[i]].ior * materials[within_[i]].ior;
    return product > 0 ? product : 1;
  }
  /// After an event S at the boundary of a solid (is_solid_glass), on the side seen.
  void scatter(std::uint32_t material, bool front, bool transmitted) {
    if (transmitted) {
      if (front) enter(material);
      else leave(material);
    } else if (!front && count_ == 0) {
      enter(material);  // reflected where the path started
    }
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

  std::uint32_t within_[kDeepest];  ///< the innermost last
  int count_ = 0;
};

}  // namespace tempolux
