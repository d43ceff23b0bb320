// lib/render/photon_splats.h -- light tracing: connects each stored photon to the camera.
#pragma once

#include <cstdint>
#include <optional>

#include "formats/photons/photons.h"
#include "lib/render/camera_view.h"
#include "lib/render/path_tracer.h"

namespace tempolux {

/// The contribution of one photon to the picture.
struct Splat {
  std::uint32_t pixel = 0;  ///< row * width + column
  Layer layer = Layer::indirect;
  Rgb radiance{0.0f};  ///< W/m^2/sr, mean over the pixel
};

/// Adds each photon that the camera sees to the pixel into which its position x projects:
///
///     rho / pi (1 - A(wo)) flux |wo.n| V(x, eye) / (depth^3 / d x a)
///
/// rho (1 - A(wo)) is the surface's reflectance towards the camera below its coat (Bsdf::diffuse_reflectance); the
/// photon's flux already includes the coat's transmittance for its own direction. n is the triangle's normal, d the
/// distance from the camera, depth the distance along the view axis, and a the area of a pixel on the plane at depth 1.
/// (A pixel sees the solid angle a depth^3 / d^3.) For an orthographic camera the divisor is a. V is 1 if a ray from
/// the camera meets x, times the transmittance of media.
///
/// The sum over the photons of all paths of a kind has the layer of that kind as its mean, without a density estimate,
/// points or records. The mean over any set of pixels is unbiased if the map's photons represent all paths of their
/// kind. Light that the camera sees by mirrors and glass (layer specular) is not included.
///
/// [Dutre, Lafortune, Willems 1993: Monte Carlo light tracing with direct computation of pixel intensities; formula:
/// Veach 1997, 10.1.2]
class PhotonSplats {
 public:
  /// Both arguments must outlive this object.
  PhotonSplats(const Tracer& tracer, const CameraView& view) : tracer_(tracer), view_(view) {}

  /// `shift` [m] brings the photon's position into scene space. wi: its direction (unit, towards its origin), if the
  /// map stores directions. Empty if the camera does not see the photon or if the photon belongs to no layer.
  /// Thread-safe.
  std::optional<Splat> splat(const formats::Photon& photon, Vec3d shift, std::optional<Vec3> wi) const;

 private:
  bool sees(Vec3 place, Vec3 normal, Hit& hit, Ray& ray, float& distance) const;

  const Tracer& tracer_;
  const CameraView& view_;
};

}  // namespace tempolux
