#include "lib/audit/photon_splats.h"

#include <bit>
#include <cmath>

#include "formats/octahedral.h"
#include "lib/points/footprint_density.h"
#include "lib/transport/shading.h"
#include "lib/volume/medium.h"

namespace tempolux {
namespace {

/// The layer of light of this kind; empty for kinds of media.
std::optional<Layer> layer_of(formats::PathKind kind) {
  switch (kind) {
    case formats::PathKind::direct: return Layer::direct;
    case formats::PathKind::caustic: return Layer::caustic;
    case formats::PathKind::indirect: return Layer::indirect;
    default: return std::nullopt;
  }
}

/// The point of the lens through which a photon is looked at: two numbers that follow from the photon's bits, because a
/// photon has no random numbers of its own.
Vec2 lens_of(const formats::Photon& photon) {
  std::uint64_t bits = 0x6c656e73ull;
  for (const float number : {photon.position[0], photon.position[1], photon.position[2], photon.flux[0]})
    bits = mix64(bits + std::bit_cast<std::uint32_t>(number));
  return PathRandom(bits, 0).get2(0, Purpose::lens);
}

}  // namespace

/// True if a ray from the camera towards `place` first meets a surface about there, and comes from the side of
/// `normal` or may see light that a surface transmits. Sets the ray, its hit and the distance [m] of `place` from the
/// camera.
bool PhotonSplats::sees(Vec3 place, Vec3 normal, Vec2 lens, Hit& hit, Ray& ray, float& distance) const {
  if (view_.orthographic()) {
    const std::optional<std::array<double, 2>> raster = view_.project(place);
    ray = view_.pinhole({float((*raster)[0]), float((*raster)[1])});
    ray.origin = place - ray.direction * float(view_.depth(place));
    distance = float(view_.depth(place));
  } else {
    const Vec3 eye = view_.lens_point(lens), way = place - eye;
    distance = length(way);
    ray = {eye, way * (1 / distance), 0, INFINITY};
  }
  if (!(distance > 0) || !(sees_through_ || dot(normal, ray.direction) < 0)) return false;
  if (!tracer_.intersect(ray, hit)) return false;
  return std::abs(hit.t - distance) <= kAlong * distance;
}

std::optional<Splat> PhotonSplats::splat(const formats::Photon& photon, Vec3d shift, std::optional<Vec3> wi) const {
  const std::optional<Layer> layer = layer_of(photon.kind);
  if (!layer) return std::nullopt;
  const Vec3 place = shifted(photon.position, shift);
  const Vec2 lens = view_.has_lens() ? lens_of(photon) : Vec2{0.5f, 0.5f};
  const std::optional<std::array<double, 2>> raster = view_.project(place, lens);
  if (!raster ||
      !((*raster)[0] >= 0 && (*raster)[1] >= 0 && (*raster)[0] < view_.width() && (*raster)[1] < view_.height()))
    return std::nullopt;
  const Vec3 normal = vec_of(formats::decode_normal(photon.normal));
  Hit hit;
  Ray ray;
  float distance = 0;
  if (!sees(place, normal, lens, hit, ray, distance)) return std::nullopt;
  SurfacePoint point = tracer_.surface_point(hit);
  const Vec3 wo = -ray.direction;
  if (std::abs(dot(point.position - place, normal)) > kOff * distance) return std::nullopt;
  // True if the photon arrived on the side of the surface that the camera does not see.
  const bool far_side = dot(point.normal_geometric, normal) * dot(point.normal_geometric, wo) <= 0;

  const SceneFrame& frame = tracer_.frame();
  const Vec3 smooth = point.normal;
  RayCone cone = view_.cone();
  cone.advance(distance);
  const SurfaceMaterial material(frame, point, cone.width);
  if (material.values().unlit || (far_side && !transmits_diffusely(material))) return std::nullopt;
  const ShadingPoint x = far_side ? ShadingPoint::on_far_side(point, wo, material) : ShadingPoint(point, wo, material);
  if (!x.bsdf.has_diffuse()) return std::nullopt;
  Rgb radiance = x.bsdf.diffuse_reflectance(x.wo_local) * kInvPi * rgb_of(photon.flux);
  if (wi && photon.kind == formats::PathKind::caustic)
    radiance *= received_share(*wi, normal, {x.normal_geometric, x.facing(smooth), x.normal, &x.bsdf});
  const double pixel = double(view_.pixel_size(1)), depth = view_.depth(place);
  const double area = pixel * pixel * (view_.orthographic() ? 1 : depth * depth * depth / double(distance));
  radiance *= float(double(std::abs(dot(x.normal_geometric, wo))) / area);
  if (const Media* const media = frame.media.get()) [[unlikely]]
    radiance *= float(std::exp(-media->optical_depth(ray.origin, ray.direction, distance)));
  radiance *= camera_inside_.transmittance_over(frame.materials, distance);
  const auto column = std::uint32_t((*raster)[0]), row = std::uint32_t((*raster)[1]);
  return Splat{row * std::uint32_t(view_.width()) + column, *layer, radiance};
}

}  // namespace tempolux
