// tests/support/frames.h -- scenes and cameras for tests of whole frames.
#pragma once

#include "lib/points/irradiance_points.h"
#include "lib/render/frame_renderer.h"
#include "lib/render/known_light.h"
#include "lib/scene/gltf_load.h"
#include "tests/support/scenes.h"
#include "tests/support/scene_at_frame.h"

namespace tempolux::test {

/// The scene pipelines/scenes/S2_cornell_moving.glb at a frame: matte boxes, one of which moves.
struct Cornell {
  Scene scene = load_gltf("../pipelines/scenes/S2_cornell_moving.glb");
  TimeOptions time;
  Segment segment;
  SceneFrame frame;
  Tracer tracer;
  Lights lights;
  CameraView view;

  explicit Cornell(int number = 10, int width = 64, int height = 36)
      : segment(segment_of(scene, number, time)),
        frame(scene_at_frame(scene, segment, number, time)),
        tracer(frame),
        lights(frame, build_emission_table(scene, segment, time)),
        view(frame.camera(scene.camera_node("auto")), frame.origin, width, height) {}
  RenderScene render_scene() const { return {tracer, lights}; }
  /// A record of 2 W/m^2 at the place that a raster position shows. Throws if the position shows no surface.
  IrradianceRecord record_at(Vec2 raster, float radius, Rgb noise) const {
    const SeenPoint seen = seen_through(tracer, view, {raster.x, raster.y, {}}).value();
    IrradianceRecord record;
    record.position = seen.surface.position;
    record.normal = seen.normal;
    record.irradiance = Rgb(2.0f);
    record.noise = noise;
    record.radius = record.radius_unclamped = radius;
    return record;
  }
};

/// A camera at z = 1 above the origin, looking down. 64 x 36 pixels of 1/32 m; the origin is in the middle of the
/// picture.
inline CameraView from_above() {
  PlacedCamera camera;
  camera.camera.kind = Camera::Kind::orthographic;
  camera.camera.ymag_m = 0.5625f;
  camera.scene_from_camera.translation = {0, 0, 1};
  return CameraView(camera, {}, 64, 36);
}

/// Tracer and lights of a frame, which must outlive this object.
struct Lit {
  Tracer tracer;
  Lights lights;
  explicit Lit(const SceneFrame& frame) : tracer(frame), lights(frame, build_emission_table({&frame, 1})) {}
  RenderScene scene() const { return {tracer, lights}; }
};

/// Direct irradiance [W/m^2] that an irradiance point facing up holds at a position.
inline Rgb direct_at(const Tracer& tracer, const Lights& lights, Vec3 position, int samples) {
  std::vector<IrradiancePoint> points(1);
  points[0].position = position;
  points[0].normal = {0, 1, 0};
  PointOptions options;
  options.light_samples = samples;
  update_direct(tracer, lights, nullptr, options, points);
  return points[0].direct;
}

/// An empty photon map: all light but direct light is 0.
struct NoLight {
  PhotonLight photons;
  KnownLight known;
  explicit NoLight(const Tracer& tracer) : photons(tracer, {}, {}, {}) { known.photons = &photons; }
  NoLight(const NoLight&) = delete;
};

}  // namespace tempolux::test
