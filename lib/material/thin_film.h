// lib/material/thin_film.h -- the Fresnel term of a surface below a thin film (KHR_materials_iridescence).
#pragma once

#include <algorithm>
#include <cmath>

#include "lib/material/opaque_lobes.h"

namespace tempolux {

/// Fresnel term [1] of a surface with a film on the share `factor` of it, in place of Schlick: the lobes of
/// opaque_lobes.h take it as their Fresnel. Belcour & Barla, "A Practical Extension to Microfacet Theory for the
/// Modeling of Varying Iridescence", ACM TOG 36(4), 2017, in the form of KHR_materials_iridescence:
///     F = R12 + Rs + 2 sum over m = 1, 2 of (Rs - T12) sqrt(R12 R23)^m S(m path),
///     T12 = 1 - R12,   Rs = T12^2 R23 / (1 - R12 R23),   path = 2 index thickness cos_t.
/// R12 and R23 are Schlick's terms of the film's faces, and cos_t the cosine inside the film. S(x) is the cosine of the
/// phase 2 pi x / wavelength, plus pi if the base is denser than the film, as the sensor of linear Rec. 709 sees it:
/// the authors' Gaussians in place of the CIE 1931 curves. F is brought into [0, 1] in each channel. A film of 30 nm or
/// less fades out, as in the specification.
///
/// Approximate: F0 of a material between dielectric and metal is mixed before the film is applied. Schlick has no term
/// for absorbing metals.
class ThinFilm {
 public:
  /// plain: the Fresnel term without the film. factor in (0, 1]; index >= 1; thickness [nm].
  ThinFilm(const Schlick& plain, float factor, float index, float thickness);

  Rgb at(float cos_h) const;
  Rgb mean() const;  ///< cosine-weighted mean over the hemisphere, by 12 angles

  /// Share of uniform light [1] that microfacets reflect towards w; width, e: of the lobe. It is Schlick's share for
  /// the same F0 and F90, which the table gives, plus the mean over kNormals visible normals of the difference. The
  /// largest channel is within .02 of the integral for indices up to 2.5, and within .0025 for 95 % of random films.
  template <class Width>
  Rgb albedo(const Width& width, Vec3 w, AlbedoPair e) const {
    return albedo(width, w, e, kNormals);
  }
  /// Cosine-weighted mean of the albedo's largest channel [1], by 12 directions with 4 normals each; within .01.
  template <class Width>
  float mean_albedo(const Width& width, AlbedoPair) const;

 private:
  static constexpr int kNormals = 12;
  static constexpr int kAngles = 12;
  template <class Width>
  Rgb albedo(const Width& width, Vec3 w, AlbedoPair e, int normals) const;
  /// Cosine of angle i of kAngles with equal shares of uniform light.
  static float cos_of(int i) { return std::sqrt((float(i) + 0.5f) / kAngles); }
  static float fraction(float x) { return x - std::floor(x); }

  Schlick plain_;
  Schlick ends_;        ///< the term at normal and at grazing incidence
  float plain_share_;   ///< 1 - factor
  float film_share_;    ///< factor times F90 of the plain term
  float index_;         ///< of the film
  float path_;          ///< 2 index thickness [m]
  float outer_f0_;      ///< of the film's outer face
  Rgb inner_f0_{0.0f};  ///< of the face between film and base
  Rgb sign_{1.0f};      ///< -1 where the base is denser than the film
};

template <class Width>
Rgb ThinFilm::albedo(const Width& width, Vec3 w, AlbedoPair e, int normals) const {
  constexpr float kGolden = 0.618034f;
  constexpr float kTurn = Width::kDirected ? 1 : 0.5f;  // a round lobe is symmetric
  Rgb difference(0.0f);
  float sum = 0;
  for (int i = 0; i < normals; ++i) {
    const Vec2 u{kTurn * (float(i) + 0.5f) / float(normals), fraction(float(i) * kGolden + 0.5f)};
    const Vec3 h = width.sample_normal(w, u);
    const float cos = dot(w, h);
    const Vec3 wi = h * (2 * cos) - w;
    if (!(wi.z > 0)) continue;
    const float weight = width.reflection(wi, w, h) * wi.z / width.pdf_reflected(h, w);
    difference += (at(cos) - ends_.at(cos)) * weight;
    sum += weight;
  }
  const Rgb share = ends_.albedo(width, w, e) + difference * (sum > 0 ? (e.a + e.b) / sum : 0);
  return {std::clamp(share.r, 0.0f, 1.0f), std::clamp(share.g, 0.0f, 1.0f), std::clamp(share.b, 0.0f, 1.0f)};
}

template <class Width>
float ThinFilm::mean_albedo(const Width& width, AlbedoPair) const {
  constexpr int kNormalsOfMean = 4;
  constexpr float kGoldenAngle = 2.3999632f;
  float sum = 0;
  for (int i = 0; i < kAngles; ++i) {
    const float cos = cos_of(i), sin = std::sqrt(1 - cos * cos), phi = kGoldenAngle * float(i);
    const Vec3 w{sin * std::cos(phi), sin * std::sin(phi), cos};
    sum += max_component(albedo(width, w, width.albedo(w), kNormalsOfMean));
  }
  return sum / kAngles;
}

}  // namespace tempolux
