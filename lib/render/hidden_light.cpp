#include "lib/render/hidden_light.h"

#include <algorithm>

#include "lib/material/smooth_material.h"
#include "lib/render/audit.h"
#include "lib/render/pilot_photons.h"
#include "lib/render/see_photons.h"

namespace tempolux {

bool may_hide_light(const SceneFrame& frame) {
  return std::ranges::any_of(frame.lights, [](const PlacedLight& l) { return max_component(l.light.intensity) > 0; }) &&
         first_smooth_material(frame) != kNone;
}

double hidden_share(const RenderScene& scene, const Lights& without_extent, const CameraView& view, double picture) {
  const formats::PhotonBlock photons = pilot_photons(scene.tracer, without_extent, "caustic", kPilotPaths, 0);
  const SeenPhotons hidden = see_photons(scene, view, photons).caustic;
  const bool sure = hidden.mean - kAuditErrors * hidden.mean_error > kAuditLimit * picture;
  return sure ? hidden.mean / (picture > 0 ? picture : hidden.mean) : 0;
}

}  // namespace tempolux
