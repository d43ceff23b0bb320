#include "tools/common/plan_views.h"

#include <algorithm>

#include "lib/plan/plan_files.h"
#include "lib/render/seen_spheres.h"

namespace tempolux::tools {
namespace {

constexpr std::size_t kMostPictures = 16;

bool shines_from_afar(const Scene& scene, const SceneFrame& frame) {
  return scene.environment || std::ranges::any_of(frame.lights, [](const PlacedLight& placed) {
           return placed.light.kind == PunctualLight::Kind::directional;
         });
}

}  // namespace

void plan_views(SceneInput& input, int camera_node, int width, int height, Plan& plan) {
  if (plan.photon_kinds.empty()) return;
  StandingTree standing;
  for (const ViewGroup& group : view_groups(plan)) {
    std::vector<WeighedPlace> places;
    double radius = 0;
    bool from_afar = false;
    const std::size_t count = std::min(kMostPictures, group.pictures.size());
    for (std::size_t i = 0; i < count; ++i) {
      const int number = group.pictures[i * group.pictures.size() / count];
      const SceneFrame frame = input.at(number, false);
      from_afar = from_afar || shines_from_afar(input.scene(), frame);
      radius = std::max(radius, input.emission(frame.frame).sphere_radius);
      const Tracer tracer(frame, standing);
      add_seen_places(tracer, CameraView(frame.camera(camera_node), frame.origin, width, height), i, places);
      // Under lamps alone photons are not aimed, and in a room points are spread everywhere: one look tells.
      if (i == 0 && !from_afar && spheres_around(places, radius).empty()) break;
    }
    const std::vector<formats::ViewSphere> spheres = spheres_around(places, radius);
    if (from_afar || !spheres.empty()) plan.views.push_back({group.first, group.photon_frames, formats::view_text(spheres)});
  }
}

}  // namespace tempolux::tools
