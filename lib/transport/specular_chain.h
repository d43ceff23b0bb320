// lib/transport/specular_chain.h -- one event of a path at a surface, and a ray followed through mirrors and glass.
#pragma once

#include <optional>

#include "lib/material/inside.h"
#include "lib/material/surface_material.h"
#include "lib/trace/trace.h"
#include "lib/transport/shading.h"

namespace tempolux {

/// An event that was drawn at a surface.
struct Scattered {
  Bsdf::Sample sample;
  Vec3 travel{};  ///< direction of the path after the event; unit, scene space

  /// Draws an event (Bsdf::sample). `frame` and `eye` are those of the side that the path comes from. An event S never
  /// leads to the wrong side of the triangle (ShadingFrame); its pdf is ShadingPoint::pdf_specular.
  Scattered(const Bsdf& bsdf, const ShadingFrame& frame, const Bsdf::Direction& eye, float u_lobe, Vec2 u)
      : sample(bsdf.sample(eye, u_lobe, u)), travel(frame.to_world(sample.wi)) {
    if (sample.diffuse || sample.straight || frame.flat() || is_black(sample.weight)) return;
    if (!frame.on_wrong_side(travel, sample.transmitted)) return;
    travel = frame.image(travel);
    sample.wi = frame.to_local(travel);
  }
  Scattered(const ShadingPoint& x, float u_lobe, Vec2 u) : Scattered(x.bsdf, x.frame, x.eye, u_lobe, u) {}
  /// Updates the solids that the path is inside. front: the side of the surface from which the path came.
  void pass(const SurfacePoint& point, const MaterialValues& material, bool front, Inside& inside) const {
    if (!sample.diffuse && bounds_solid(material, point.plate))
      inside.scatter(point.material, front, sample.transmitted);
  }
};

/// A ray that mirrors and glass continue, surface by surface; plates refract it like other solids:
///
///     SpecularChain chain(tracer, ray);
///     while (chain.meet()) {
///       const ShadingPoint& x = chain.shade(width);
///       ...
///       chain.go_on(Scattered(x, u_lobe, u));
///     }
class SpecularChain {
 public:
  SpecularChain(const Tracer& tracer, const Ray& ray, const Inside& inside = {})
      : tracer_(tracer), ray_(ray), inside_(inside) {}

  /// Follows the ray to the next surface. False if the ray leaves the scene.
  bool meet();
  /// Returns the shading of the surface that meet() found, with textures averaged over `width` m. The reference is
  /// valid until the next meet().
  const ShadingPoint& shade(float width);
  /// Continues the ray by an event at the surface.
  void go_on(const Scattered& event);

  const Ray& ray() const { return ray_; }               ///< the ray that met the surface
  float leg() const { return hit_.t; }                  ///< m: length of the path's last straight part
  float way() const { return way_; }                    ///< m: length of the path
  bool front() const { return front_; }                 ///< true if the path came from the surface's front
  Rgb& passed() { return passed_; }                     ///< product of transmittances and of the events' weights [1]
  const SurfacePoint& point() const { return point_; }  ///< shade() applies the normal map
  std::uint32_t events() const { return events_; }      ///< number of events
  const MaterialValues& material() const { return material_->values(); }  ///< of the surface; after shade()

 private:
  const Tracer& tracer_;
  Ray ray_;
  Inside inside_;
  Hit hit_;
  SurfacePoint point_;
  std::optional<SurfaceMaterial> material_;
  std::optional<ShadingPoint> shading_;
  Rgb passed_{1.0f};
  float way_ = 0;
  bool front_ = false;
  std::uint32_t events_ = 0;
};

}  // namespace tempolux
