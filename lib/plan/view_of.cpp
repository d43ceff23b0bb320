#include "lib/plan/view_of.h"

#include <algorithm>
#include <set>
#include <utility>

#include "formats/hash.h"
#include "lib/pilot/photon_shares.h"
#include "lib/pilot/seen_spheres.h"

namespace tempolux {

std::vector<int> frames_of(std::span<const PlannedSegment> pieces) {
  std::vector<int> frames;
  for (int f = pieces.front().first; f <= pieces.back().last; ++f) frames.push_back(f);
  return frames;
}

std::string view_of(const std::vector<int>& frames, const std::string& kinds, const Wish& wish,
                    const SceneSource& source, StaticTree& tree) {
  SeenAround around;
  double radius = 0;
  std::set<std::string> cameras, states;
  const std::vector<int> some = spread(frames);
  for (const int number : some) {
    const SceneFrame frame = source.at(number, false);
    const PlacedCamera camera = frame.camera(source.camera_node);
    if (!cameras.insert(pinhole_hash(camera)).second) continue;
    const EmissionTable table = source.emission(frame.frame);
    radius = std::max(radius, table.sphere_radius);
    look_around(Tracer(frame, tree), camera, wish.width, wish.height, around);
    // Photons are aimed if they come from distant light, and they are shared out if there are several lights. Without
    // both, spheres only serve the points. Then the first picture decides whether the scene is large enough for
    // spheres.
    if (number == frames.front() && !frame.scene->has_distant_light() && !has_several_lights(frame, table) &&
        !seen_spheres(around.places, radius).worth_aiming)
      return "";
  }
  SeenSpheres seen = seen_spheres(around.places, radius);
  SharePilot pilot(seen.spheres, around.places, kinds);
  for (const int number : {some.front(), some[some.size() / 2], some.back()}) {
    const SceneFrame frame = source.at(number, false);
    const SceneHashes& hashes = frame.hashes;
    if (!states.insert(hash_of_texts({hashes.moving_geometry, hashes.materials, hashes.lights})).second) continue;
    EmissionTable table = source.emission(number);
    if (seen.worth_aiming) table.aim = spheres_in_scene(seen.spheres, frame.origin);
    if (frame.scene->has_distant_light() || has_several_lights(frame, table)) pilot.look(Tracer(frame, tree), table);
  }
  if (!seen.worth_aiming) seen.spheres.clear();
  const formats::View view{std::move(seen.spheres), pilot.openings(), pilot.shares()};
  return view.spheres.empty() && view.openings.empty() && view.lights.empty() ? "" : formats::view_text(view);
}

}  // namespace tempolux
