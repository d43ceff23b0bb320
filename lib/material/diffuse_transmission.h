// lib/material/diffuse_transmission.h -- the Lambert lobe that sends light to the other side of a surface
// (KHR_materials_diffuse_transmission): paper, leaves, cloth.
//
// With wi and wo on different sides of the surface and the coupling c of bsdf.h, the lobe is
//     f(wi, wo) = tau / pi  c(wi) c(wo).
// c keeps its value if a direction and the normal are both turned round. So f is also the value of a reflecting Lambert
// lobe of the colour tau for light from wi and a viewer at -wo, both on one side. A path that meets such a surface
// draws the side from which it goes on. On its own side it finds the reflecting lobes. On the far side it finds one
// Lambert lobe with the viewer at -wo, so light samples, records, points and photons of that side serve it as they
// serve any surface.
#pragma once

#include "lib/material/bsdf.h"

namespace tempolux {

inline bool transmits_diffusely(const MaterialValues& m) { return m.diffuse_transmission > 0 && m.metallic < 1; }

/// The material for a path that goes on from the far side: its only lobe is the Lambert lobe that transmits.
inline MaterialValues on_far_side(MaterialValues material) {
  material.from_far_side = true;
  return material;
}

/// Reflectances of both Lambert lobes together, without coupling and without the share of glass [1].
inline Rgb diffuse_albedo_of_both(const MaterialValues& m) {
  const Rgb reflected = Bsdf(m).diffuse_albedo();
  if (!transmits_diffusely(m)) return reflected;
  return reflected + m.diffuse_transmission_color * (m.diffuse_transmission * (1 - m.metallic));
}

/// The side from which a path goes on at a surface that transmits diffusely.
struct SideChoice {
  bool far_side = false;  ///< false: the side from which the path came
  float chance = 1;       ///< probability of this choice, above 0; the path's throughput is divided by it

  /// True if there was nothing to choose: the path goes on from its own side, with its own throughput.
  bool is_plain() const { return !far_side && chance == 1; }
};

/// Chooses a side by u in [0, 1). The chance of a side is proportional to the light that its lobes send towards wo if
/// light is uniform. bsdf: of the path's own side. wo: unit, in the local frame of `bsdf`; a direction below the
/// surface counts as the normal.
SideChoice choose_side(const Bsdf& bsdf, Vec3 wo, const MaterialValues& material, float u);

}  // namespace tempolux
