// tests/lib/light/light_scene.h -- scenes of lights made by hand.
#pragma once

#include <deque>
#include <utility>
#include <vector>

#include "lib/light/lights.h"
#include "lib/scene/at_frame.h"

namespace tempolux {

/// A frame whose surfaces are triangles given by their corners, one surface each call.
struct LightScene {
  std::deque<Primitive> primitives;  // addresses stay
  SceneFrame frame;

  /// The scene sphere: of the box [-half, half]^3.
  explicit LightScene(float half = 5) {
    frame.bounds.add(Vec3{-half, -half, -half});
    frame.bounds.add(Vec3{half, half, half});
  }
  /// Fan over the corners, counter-clockwise seen from the front.
  std::uint32_t add(const std::vector<Vec3>& corners, Rgb emission, bool double_sided = false, bool flipped = false) {
    Material material;
    material.emission = emission;
    material.double_sided = double_sided;
    Primitive& primitive = primitives.emplace_back();
    primitive.positions = corners;
    for (std::uint32_t i = 2; i < corners.size(); ++i) primitive.triangles.push_back({0, i - 1, i});
    Surface surface;
    surface.material = std::uint32_t(frame.materials.size());
    surface.flipped = flipped;
    surface.primitive = &primitive;
    surface.positions = SharedArray<Vec3>(corners);
    frame.materials.push_back(material);
    frame.surfaces.push_back(surface);
    frame.static_count = frame.surfaces.size();
    return std::uint32_t(frame.surfaces.size() - 1);
  }
  void add(PunctualLight::Kind kind, Rgb intensity, Vec3 position, Vec3 direction, float inner = 0,
           float outer = 0.7f) {
    PlacedLight placed;
    placed.light.kind = kind;
    placed.light.intensity = intensity;
    placed.light.inner_cone_rad = inner;
    placed.light.outer_cone_rad = outer;
    placed.position = position;
    placed.direction = direction;
    frame.lights.push_back(placed);
  }
  EmissionTable table() const { return build_emission_table(std::span<const SceneFrame>(&frame, 1)); }
  Lights lights() const { return Lights(frame, table()); }
};

/// pdf [1/sr] with which sample() chooses a direction of the environment.
inline float pdf_environment(const Lights& lights, Vec3 point, Vec3 normal, Vec3 direction) {
  return lights.pdf_environment(point, normal, lights.environment_place(direction), direction, Lights::From::all);
}

/// Square of side 2 `half` around the centre, in a plane of constant z, facing down.
inline std::vector<Vec3> square_facing_down(Vec3 centre, float half) {
  return {centre + Vec3{-half, -half, 0}, centre + Vec3{-half, half, 0}, centre + Vec3{half, half, 0},
          centre + Vec3{half, -half, 0}};
}

/// Irradiance [W/m^2] of a polygon of radiance 1, all above the horizon, by Lambert: half the sum over edges
/// of the angle they fill times the cosine of their plane's normal.
inline double polygon_irradiance(Vec3 point, Vec3 normal, const std::vector<Vec3>& corners) {
  double sum = 0;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const Vec3d a = normalize(Vec3d(corners[i]) - Vec3d(point));
    const Vec3d b = normalize(Vec3d(corners[(i + 1) % corners.size()]) - Vec3d(point));
    const Vec3d c = cross(a, b);
    sum += std::atan2(length(c), dot(a, b)) * dot(normalize(c), Vec3d(normal));
  }
  return std::abs(sum) / 2;
}

}  // namespace tempolux
