// lib/audit/photon_splats.h -- light tracing: connects each stored photon to the camera.
#pragma once

#include <cstdint>
#include <optional>

#include "formats/photons/photons.h"
#include "lib/render/camera_view.h"
#include "lib/material/diffuse_transmission.h"
#include "lib/render/path_tracer.h"

namespace tempolux {

/// Contribution of one photon to the picture.
struct Splat {
  std::uint32_t pixel = 0;  ///< row * width + column
  Layer layer = Layer::indirect;
  Rgb radiance{0.0f};  ///< W/m^2/sr, mean over the pixel
};

/// Computes the radiance that a photon at x adds to the pixel into which x projects:
///
///     rho / pi (1 - A(wo)) flux |wo.n| V(x, eye) / (depth^3 / d a)
///
/// rho (1 - A(wo)) is the surface's reflectance towards the camera below its coat (Bsdf::diffuse_reflectance). The flux
/// already includes the coat's transmittance for the photon's own direction. n is the triangle's normal, d the distance
/// from the camera, depth the distance along the view axis, and a the area of a pixel on the plane at depth 1. (A pixel
/// sees the solid angle a depth^3 / d^3.) With a lens the eye is a point of the lens that is drawn for each photon; the
/// solid angle of a pixel from there has the same form. For an orthographic camera the divisor is a. V is the
/// transmittance of media and of the solid that the camera is in if a ray from the camera meets x, else 0.
///
/// If x has a material that transmits diffusely and the camera sees its other side, rho is that of the lobe that
/// transmits.
///
/// The sum over the photons of a map is an unbiased estimate of the layer of their kind, in each pixel and over any set
/// of pixels, if the map stores all photons of this kind. It needs no density estimate, points or records. Light that
/// the camera sees by mirrors and glass (layer specular) is not included.
///
/// [Dutre, Lafortune, Willems 1993: Monte Carlo light tracing with direct computation of pixel intensities; formula:
/// Veach 1997, 10.1.2]
class PhotonSplats {
 public:
  /// `tracer` and `view` must outlive this object.
  PhotonSplats(const Tracer& tracer, const CameraView& view, const Inside& camera_inside = {})
      : tracer_(tracer), view_(view), camera_inside_(camera_inside) {
    for (const Material& material : tracer.frame().materials) sees_through_ |= transmits_diffusely(material);
  }

  /// `shift` [m] is added to the photon's position to bring it into scene space. wi: its direction (unit, towards where
  /// it came from), if the map stores directions. Empty if the camera does not see the photon, or if its kind is volume
  /// or tentative. Thread-safe.
  std::optional<Splat> splat(const formats::Photon& photon, Vec3d shift, std::optional<Vec3> wi) const;

  /// Tolerances for the test whether a ray to x meets x's own surface, in units of the distance from the ray's start:
  /// along the normal and along the surface. Positions are exact to 1e-7 of the scene; the rest allows for grazing
  /// rays. Surfaces that lie closer together than this are not distinguished.
  static constexpr float kOff = 1e-4f, kAlong = 1e-2f;

 private:
  bool sees(Vec3 place, Vec3 normal, Vec2 lens, Hit& hit, Ray& ray, float& distance) const;

  const Tracer& tracer_;
  const CameraView& view_;
  Inside camera_inside_;       ///< the absorbing solid that the camera is in
  bool sees_through_ = false;  ///< true if a material transmits diffusely
};

}  // namespace tempolux
