// lib/material/dielectric_lobe.h -- the boundary of glass: reflects, and transmits to the other side.
#pragma once

#include <optional>

#include "lib/material/lobe.h"
#include "lib/material/rough_glass.h"
#include "lib/material/thin_film.h"
#include "lib/scene/scene.h"

namespace tempolux {

/// Glass (KHR_materials_transmission), which is the share transmission (1 - metallic) of a surface. It reflects by the
/// exact Fresnel equations and transmits the remaining light, tinted by base_color at each boundary. Light is refracted
/// at a solid (index ior inside) and goes straight through a thin wall. The boundary is smooth below kMirrorRoughness,
/// else rough_glass.h describes it.
///
/// A plate (lib/trace/plates.h) is passed straight. Its outer side reflects and transmits what the whole plate does,
///     R = F + tint^2 (1 - F)^2 F A^2 / (1 - F^2 A^2),    T = tint (1 - F)^2 A / (1 - F^2 A^2),
/// where F is the Fresnel term at a face, the same at both, and A the transmittance of the way from face to face,
/// thickness / cos_t. These are the sums over all reflections between the faces [Born & Wolf, without interference].
/// The inner side transmits all light, tinted, and reflects none.
///
/// A thin film on smooth glass (thin_film.h) replaces F, by channel, on both sides of a boundary: light that leaves a
/// solid is reflected as light that enters along the same way. Rough glass shows no film.
class DielectricLobe {
 public:
  /// front: wo is outside of a solid. plate [m]: thickness of the plate, 0 for other glass.
  DielectricLobe(const MaterialValues& material, bool front, float plate = 0);

  float share() const { return share_; }
  bool is_delta() const { return !rough_; }
  float light_share_behind() const { return light_share_behind_; }  ///< Bsdf::light_share_behind()
  /// The share [1] of light that a smooth boundary reflects towards cos_o > 0; of a plate and below a film, the
  /// probability with which sample() reflects.
  float reflectance(float cos_o) const;
  /// True if a smooth boundary reflects and transmits. The inner side of a plate only transmits.
  bool reflects() const { return !plate_ || plate_->outer; }
  /// Bsdf::passed_straight() for cos_o > 0.
  Rgb passed_straight(float cos_o) const;

  /// f [1/sr] with the share; wo.z > 0. 0 for a smooth boundary.
  Rgb eval(Vec3 wi, Vec3 wo) const;
  /// pdf [1/sr] with which sample() draws wi, times the share; wo.z > 0. 0 for a smooth boundary.
  float pdf_solid_angle(Vec3 wi, Vec3 wo) const {
    return rough_ && wi.z != 0 ? share_ * rough_->pdf_solid_angle(wi, wo) : 0;
  }
  /// Draws wi for wo.z > 0. A smooth boundary sets all of s, a rough one wi (0 if light is lost) and transmitted.
  void sample(Vec3 wo, float u_lobe, Vec2 u, LobeSample& s) const;

 private:
  struct Plate {
    bool outer;  ///< the lobe is that of the outer side
    Rgb across;  ///< transmittance of the glass straight across
  };
  struct Shares {
    Rgb reflected, passed;
    float chance() const {  ///< probability with which sample() reflects
      const float r = max_component(reflected);
      return r > 0 ? r / (r + max_component(passed)) : 0;
    }
  };
  Rgb reflectance_of_face(float cos_o, float& cos_t) const;
  Shares shares(float cos_o, float& cos_t) const;
  void sample_by_channel(Vec3 wo, float u_lobe, LobeSample& s) const;

  float share_;
  Rgb tint_;
  float eta_reflected_;  ///< for the Fresnel term: index on wo's side / index on the other side
  float eta_;            ///< for refraction: the same quotient, but 1 for a thin wall
  float light_share_behind_ = 0;
  bool pane_;  ///< the wall is thin and smooth
  std::optional<Plate> plate_;
  std::optional<ThinFilm> film_;
  std::optional<RoughGlass> rough_;  ///< empty: the boundary is smooth
};

}  // namespace tempolux
