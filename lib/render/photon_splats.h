// lib/render/photon_splats.h -- stored photons seen by the camera, one by one: light tracing.
#pragma once

#include <cstdint>
#include <optional>

#include "formats/photons/photons.h"
#include "lib/render/camera_view.h"
#include "lib/render/path_tracer.h"

namespace tempolux {

/// What one photon adds to the picture.
struct Splat {
  std::uint32_t pixel = 0;  ///< row * width + column
  Layer layer = Layer::indirect;
  Rgb radiance{0.0f};  ///< W/m^2/sr, mean over the pixel
};

/// A photon that the camera can see adds to the pixel that its place x projects to
///
///     rho / pi (1 - A(wo)) flux |wo.n| V(x, eye) / (depth^3 / d x a)
///
/// rho (1 - A(wo)): what the surface returns towards the eye of what its coat lets in
/// (Bsdf::diffuse_reflectance); the photon's flux already has the coat's share of
/// where it came from. n: the triangle's normal, d: distance from the eye, depth: along the view axis, a: a
/// pixel's area on the plane at depth 1. (A pixel sees the solid angle
/// a depth^3 / d^3.) Orthographic: divided by a alone. V: a ray from the eye meets x; media attenuate it.
/// The sum over the photons of all paths of a kind is, in the mean, the layer of that kind: no density, no
/// points and no records are in it, only the photons' own paths. The mean
/// over any set of pixels is unbiased, if each photon of the map stands for all paths of its kind. What the
/// eye sees by mirrors and glass (layer specular) is not in it.
/// [Dutre, Lafortune, Willems 1993: Monte Carlo light tracing with direct computation of pixel intensities;
/// formula: Veach 1997, 10.1.2]
class PhotonSplats {
 public:
  /// All must outlive it.
  PhotonSplats(const Tracer& tracer, const CameraView& view) : tracer_(tracer), view_(view) {}

  /// `shift` [m] takes the photon's place into the scene's space; wi: its direction (unit, back to where it
  /// came from) if the map has them. None if the camera does not see it, or if it is
  /// of no layer. Thread-safe.
  std::optional<Splat> splat(const formats::Photon& photon, Vec3d shift, std::optional<Vec3> wi) const;

 private:
  bool sees(Vec3 place, Vec3 normal, Hit& hit, Ray& ray, float& distance) const;

  const Tracer& tracer_;
  const CameraView& view_;
};

}  // namespace tempolux
