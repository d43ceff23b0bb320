// lib/material/lobe.h -- the functions that every lobe of a Bsdf has, with their arguments and results.
#pragma once

#include <algorithm>

#include "lib/core/vec.h"

namespace tempolux {

/// The share of uniform light that a lobe reflects towards a direction w [1].
struct LobeAlbedo {
  Rgb single{0.0f}, multiple{0.0f};  ///< shares reflected by one and by several microfacets
  float lost = 0;                    ///< 1 - E: the share that GGX alone would lose at F = 1
  float kept = 0;                    ///< share that the lobes below do not get, equal for all channels
  float passed = 1;                  ///< share of light that passes the lobes above, which Bsdf sets
  Rgb total() const { return single + multiple; }
  void keep_largest() { kept = max_component(total()); }  ///< the lobes below get what no channel reflects
};

/// A direction as one lobe sees it: unit, local frame.
struct LobeDirection {
  const Vec3& w;
  const LobeAlbedo& albedo;
};

/// Factor [1] of a lobe of event S below other lobes (head of bsdf.h).
inline float passed_both(LobeDirection wi, LobeDirection wo) { return std::min(wi.albedo.passed, wo.albedo.passed); }

struct LobeSample {
  Vec3 wi{};                  ///< unit, away from the surface
  Rgb weight{0.0f};           ///< f cos / pdf of the drawn event alone, divided by the event's probability [1]
  float pdf_solid_angle = 0;  ///< pdf of wi over all non-delta lobes [1/sr]; if delta, the probability of the lobe [1]
  bool diffuse = false;       ///< event D, else S
  bool delta = false;         ///< mirror or smooth glass
  bool transmitted = false;   ///< wi is on the other side, z < 0
  bool straight = false;      ///< light passes a pane, wi = -wo, which is no event
};

// A lobe of event S is a class with these functions. Bsdf calls them only for wi and wo on the side z > 0.
//
//   static constexpr bool kDelta         true for a mirror: eval() and pdf_solid_angle() return 0
//   float mean_kept() const              cosine-weighted mean of LobeAlbedo::kept [1]
//   LobeAlbedo albedo(Vec3 w) const
//   Rgb eval(wi, wo) const               f [1/sr], with the lobe's share and passed_both()
//   float pdf_solid_angle(Vec3 wi, wo) const         pdf with which sample() draws wi [1/sr]
//   void sample(wo, float u_lobe, Vec2 u, LobeSample& s) const
//                                        sets s.wi, s.delta, s.pdf_solid_angle: pdf_solid_angle(wi), 1 if delta, 0 if
//                                        nothing is reflected
//   Rgb weight(wi, wo, float chance, float pdf) const
//                                        f cos / pdf of a sample [1], without the lobe's share. The lobe is drawn with
//                                        the probability `chance`, which `pdf` includes.

}  // namespace tempolux
