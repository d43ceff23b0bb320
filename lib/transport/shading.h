// lib/transport/shading.h -- a surface point with the side that a ray sees and its Bsdf.
#pragma once

#include <optional>

#include "lib/material/bsdf.h"
#include "lib/material/diffuse_transmission.h"
#include "lib/material/seen_side.h"
#include "lib/trace/trace.h"

namespace tempolux {

/// f_S [1/sr] of light from wi towards the eye (local frame), with the light that the lobes send to wi's image
/// (ShadingFrame): times wi's cosine to the shading normal it is the radiance per irradiance. wi is on the eye's side
/// by both normals.
inline Rgb eval_specular(const Bsdf& bsdf, const ShadingFrame& frame, const Bsdf::Direction& wi,
                         const Bsdf::Direction& eye) {
  const Rgb f = bsdf.eval_specular(wi, eye);
  const std::optional<Vec3> image = frame.image_in_lobe(wi.w);
  return image ? f + bsdf.eval_specular(bsdf.along(*image), eye) * (image->z / wi.w.z) : f;
}
/// Bsdf::gloss_density() of Scattered, which draws wi and its image (unit, local frame).
inline float gloss_density(const Bsdf& bsdf, const ShadingFrame& frame, Vec3 wi, const Bsdf::Direction& eye) {
  const std::optional<Vec3> image = frame.image_in_lobe(wi);
  return bsdf.gloss_density(wi, eye) + (image ? bsdf.gloss_density(*image, eye) : 0);
}

/// A surface point seen from direction wo (unit, towards the viewer). point: with the material's normal map applied.
struct ShadingPoint : SeenSide {
  SurfacePoint surface;
  Bsdf bsdf;
  Bsdf::Direction eye;  ///< wo_local, with what the Bsdf needs of it

  ShadingPoint(const SurfacePoint& point, Vec3 wo, const MaterialValues& material)
      : SeenSide(point, wo),
        surface(point),
        bsdf(material, dot(point.normal_geometric, wo) > 0, frame, Carries::radiance, point.plate),
        eye(bsdf.along(wo_local)) {}

  /// The far side of a surface that transmits diffusely, for the same wo (diffuse_transmission.h).
  static ShadingPoint on_far_side(const SurfacePoint& point, Vec3 wo, const MaterialValues& material) {
    return {point, -wo, tempolux::on_far_side(material)};
  }

  /// f_S [1/sr], as above.
  Rgb eval_specular(const Bsdf::Direction& wi) const { return tempolux::eval_specular(bsdf, frame, wi, eye); }
  float gloss_density(Vec3 wi) const { return tempolux::gloss_density(bsdf, frame, wi, eye); }
  /// Bsdf::pdf_specular() of Scattered, which draws wi and its image (unit, local frame).
  float pdf_specular(Vec3 wi) const {
    const std::optional<Vec3> image = frame.image_in_lobe(wi);
    return bsdf.pdf_specular(wi, eye) + (image ? bsdf.pdf_specular(*image, eye) : 0);
  }
};

}  // namespace tempolux
