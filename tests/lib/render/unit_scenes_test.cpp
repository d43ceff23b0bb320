// The hand-written scenes of tests/data/units, whose centre pixel is known in closed form (expected.json says
// how), by the path tracer within 0.3 % and by photon density within 1 %.
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>

#include "lib/core/sampling.h"
#include "lib/photon/photon_trace.h"
#include "lib/render/camera_view.h"
#include "lib/render/path_tracer.h"
#include "lib/scene/gltf_load.h"
#include "tests/support/scene_at_frame.h"

namespace tempolux {
namespace {

struct UnitScene {
  Scene scene;
  TimeOptions time;
  Segment segment;
  SceneFrame frame;
  Tracer tracer;
  Lights lights;

  /// widen: surface 0, the receiver of U6 to U8, is a plate of 4 cm under the lamp. It is widened to 2 m so that more
  /// photons hit it; the light at its centre stays the same.
  explicit UnitScene(const std::string& name, bool widen = false)
      : scene(load_gltf("data/units/" + name + ".gltf")),
        segment(segment_of(scene, 0, time)),
        frame(widen ? widened(scene_at_frame(scene, segment, 0, time)) : scene_at_frame(scene, segment, 0, time)),
        tracer(frame),
        lights(frame, build_emission_table(scene, segment, time)) {}

  static SceneFrame widened(SceneFrame frame) {
    std::vector<Vec3> positions(frame.surfaces[0].positions.begin(), frame.surfaces[0].positions.end());
    for (Vec3& p : positions) p = {p.x * 50, p.y, p.z * 50};
    frame.surfaces[0].positions = positions;
    return frame;
  }

  Ray centre_ray() const {
    const CameraView view(frame.camera(scene.camera_node("auto")), frame.origin, 16, 9);
    return view.pinhole({8, 4.5f});
  }
};

nlohmann::json expected(const std::string& name) {
  std::ifstream file("data/units/expected.json");
  return nlohmann::json::parse(file).at(name).at("center");
}

/// Irradiance of a horizontal point below a polygon of radiance 1, Lambert's formula:
/// 1/2 sum over the edges of (angle between their ends seen from the point) x (vertical part of the edge plane's
/// normal).
double polygon_irradiance(const std::vector<Vec3d>& corners, Vec3d point) {
  double sum = 0;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const Vec3d a = normalize(corners[i] - point), b = normalize(corners[(i + 1) % corners.size()] - point);
    const Vec3d n = cross(a, b);
    sum += std::atan2(length(n), dot(a, b)) * n.y / length(n);
  }
  return std::abs(sum) / 2;
}

/// Mean irradiance over the disc of radius r around the origin, relative to its centre, under the lamp that is
/// surface 1: 64 rings x 64 directions.
double disc_over_centre(const SceneFrame& frame, double r) {
  const auto& p = frame.surfaces[1].positions;
  const std::vector<Vec3d> lamp{Vec3d(p[0]), Vec3d(p[1]), Vec3d(p[2]), Vec3d(p[3])};
  double sum = 0;
  for (int i = 0; i < 64; ++i)
    for (int j = 0; j < 64; ++j) {
      const double ring = r * std::sqrt((i + 0.5) / 64), phi = 2 * M_PI * (j + 0.5) / 64;
      sum += polygon_irradiance(lamp, {ring * std::cos(phi), 0, ring * std::sin(phi)});
    }
  return sum / (64 * 64) / polygon_irradiance(lamp, {0, 0, 0});
}

class UnitScenes : public testing::TestWithParam<const char*> {};

TEST_P(UnitScenes, PathTracerWithinThreePerMille) {
  const UnitScene unit(GetParam());
  const nlohmann::json centre = expected(GetParam());
  RayCounts counts;
  // The longest paths are those of the closed furnace of reflectance 0.8: their sum has a standard deviation
  // of sqrt(0.8) of its mean, 2^18 samples leave 0.17 % of it at random and less when stratified: 0.07 % seen.
  constexpr int kSamples = 1 << 18;
  Rgbd sum{0.0};
  for (std::uint32_t s = 0; s < kSamples; ++s)
    for (const Rgb& layer :
         trace_eye_path({unit.tracer, unit.lights}, unit.centre_ray(), PixelRandom(1, 0, s), nullptr, counts).value)
      sum += Rgbd(layer);
  for (int c = 0; c < 3; ++c)
    EXPECT_NEAR(sum[c] / kSamples / centre[std::size_t(c)].get<double>(), 1, 0.003) << "channel " << c;
}

/// Photons of all kinds that arrive within r of the centre, on the side that the camera sees, over pi r^2, times
/// rho/pi, plus the surface's emission. Under point lights r is a sixteenth of their distance: the curvature of the
/// irradiance, -3/4 (r/d)^2, changes it by 0.3 %. Under area lights the mean over the disc is known, too.
TEST_P(UnitScenes, PhotonDensityWithinOnePercent) {
  const std::string name = GetParam();
  const bool area_light = name >= "U6";
  const UnitScene unit(name, area_light);
  const nlohmann::json centre = expected(name);
  Hit hit;
  const Ray ray = unit.centre_ray();
  ASSERT_TRUE(unit.tracer.intersect(ray, hit));
  const SurfacePoint x = unit.tracer.surface_point(hit);
  const Material& material = unit.frame.materials[x.material];
  const Vec3 normal = dot(x.normal_geometric, ray.direction) < 0 ? x.normal_geometric : -x.normal_geometric;
  const double radius = area_light ? 0.25 : 0.12;
  const double disc = area_light ? disc_over_centre(unit.frame, radius) : 1;

  constexpr int kSeeds = 4;
  Rgbd flux{0.0};
  for (std::uint64_t seed = 0; seed < kSeeds; ++seed) {
    PhotonOptions options;
    options.seed = seed;
    options.photon_count = 2'000'000;
    const PhotonTracer photons(unit.tracer, unit.lights, options);
    for (std::size_t b = 0; b < photons.batch_count(); ++b)
      for (const formats::Photon& photon : photons.trace(b).block.photons) {
        const Vec3 p{photon.position[0], photon.position[1], photon.position[2]};
        const auto n = formats::decode_normal(photon.normal);
        if (double(length(p - x.position)) <= radius && dot(Vec3{n[0], n[1], n[2]}, normal) > 0.5f)
          flux += Rgbd(double(photon.flux[0]), double(photon.flux[1]), double(photon.flux[2]));
      }
  }
  for (int c = 0; c < 3; ++c) {
    const double irradiance = flux[c] / kSeeds / (M_PI * radius * radius);
    const double radiance = double(material.emission[c]) + double(material.base_color[c]) / M_PI * irradiance / disc;
    EXPECT_NEAR(radiance / centre[std::size_t(c)].get<double>(), 1, 0.01) << "channel " << c;
  }
}

INSTANTIATE_TEST_SUITE_P(Units, UnitScenes,
                         testing::Values("U1_point", "U2_directional", "U3_spot", "U4_furnace_quad",
                                         "U5_furnace_closed", "U6_area_quad", "U7_area_close", "U8_area_low_offset"));

}  // namespace
}  // namespace tempolux
