// lib/material/thin_film.h -- the Fresnel term of a surface below a thin film (KHR_materials_iridescence).
#pragma once

#include <algorithm>
#include <cmath>

#include "lib/material/opaque_lobes.h"

namespace tempolux {

/// Reflectance [1] of a film whose faces have the reflectances `outer` and `inner`: the sum of ThinFilm without its
/// limits. first, second: S for m = 1 and 2.
inline float film_reflectance(float outer, float inner, float first, float second) {
  const float both = std::clamp(outer * inner, 1e-5f, 0.9999f), through = 1 - outer;
  const float all = through * through * inner / (1 - both);
  return outer + all + 2 * (all - through) * (std::sqrt(both) * first + both * second);
}

/// Fresnel term [1] of a surface with a film on the share `factor` of it, in place of Schlick: the lobes of
/// opaque_lobes.h take it as their Fresnel. Belcour & Barla, "A Practical Extension to Microfacet Theory for the
/// Modeling of Varying Iridescence", ACM TOG 36(4), 2017, in the form of KHR_materials_iridescence:
///     F = R12 + Rs + 2 (Rs - T12) sum over m = 1, 2 of sqrt(R12 R23)^m S(m path),
///     T12 = 1 - R12,   Rs = T12^2 R23 / (1 - R12 R23),   path = 2 index thickness cos_t.
/// R12 and R23 are Schlick's terms of the film's faces, and cos_t is the cosine inside the film. S(x) is the cosine of
/// the phase 2 pi x / wavelength, plus pi m if the base is denser than the film, as the sensor of linear Rec. 709 sees
/// it: the authors' Gaussians replace the CIE 1931 curves. As in the specification, S is seen in light of equal energy,
/// and the mean R12 + Rs is white. F is brought into [0, 1] in each channel. A film below 30 nm fades out.
///
/// Approximate: F0 of a material between dielectric and metal is mixed before the film is applied. A metal's face turns
/// the phase by 0 or pi, as if it did not absorb.
class ThinFilm {
 public:
  /// plain: the Fresnel term without the film. factor in (0, 1]; index >= 1; thickness [nm].
  ThinFilm(const Schlick& plain, float factor, float index, float thickness);

  Rgb at(float cos_h) const;
  Rgb mean() const;               ///< cosine-weighted mean over the hemisphere, by kAngles angles
  float mean_of_largest() const;  ///< the same of the largest channel, which differs from angle to angle

  /// Share of uniform light [1] that microfacets reflect towards w; width, e: of the lobe. It is Schlick's share for
  /// the same F0 and F90, which the table gives, plus the mean over kNormals visible normals of the difference. The
  /// largest channel is within .02 of the integral for indices up to 2.5, and within .01 for those of soap, oil and
  /// oxides.
  template <class Width>
  Rgb albedo(const Width& width, Vec3 w, AlbedoPair e) const {
    return albedo(width, w, e, kNormals, 0);
  }
  /// Cosine-weighted mean of the albedo's largest channel [1], by 12 directions with 4 normals each; within .01.
  template <class Width>
  float mean_albedo(const Width& width, AlbedoPair e) const;

 private:
  static constexpr int kNormals = 12;
  static constexpr int kAngles = 12;
  template <class Width>
  Rgb albedo(const Width& width, Vec3 w, AlbedoPair e, int normals, float shift) const;
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
Rgb ThinFilm::albedo(const Width& width, Vec3 w, AlbedoPair e, int normals, float shift) const {
  constexpr float kGolden = 0.618034f;
  // For a round lobe w is turned into the plane y = 0, in which the normals are symmetric.
  constexpr float kTurn = Width::kDirected ? 1 : 0.5f;
  if (!Width::kDirected) w = {std::sqrt(std::max(0.0f, 1 - w.z * w.z)), 0, w.z};
  Rgb difference(0.0f);
  float sum = 0;
  for (int i = 0; i < normals; ++i) {
    const Vec2 u{kTurn * fraction((float(i) + 0.5f) / float(normals) + 0.3f * shift),
                 fraction(float(i) * kGolden + 0.5f + shift)};
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
float ThinFilm::mean_albedo(const Width& width, AlbedoPair e) const {
  constexpr int kNormalsOfMean = 4;
  constexpr float kGolden = 0.618034f, kGoldenAngle = 2.3999632f;
  const float f0 = max_component(ends_.f0);
  float difference = 0;  // from Schlick, whose mean is known
  for (int i = 0; i < kAngles; ++i) {
    const float cos = cos_of(i), sin = std::sqrt(1 - cos * cos), phi = kGoldenAngle * float(i);
    const Vec3 w{sin * std::cos(phi), sin * std::sin(phi), cos};
    const AlbedoPair at_w = width.albedo(w);
    difference +=
        max_component(albedo(width, w, at_w, kNormalsOfMean, kGolden * float(i))) - (f0 * at_w.a + ends_.f90 * at_w.b);
  }
  return f0 * e.a + ends_.f90 * e.b + difference / kAngles;
}

}  // namespace tempolux
