#include "tools/stages/lit_frame.h"

#include "lib/pilot/places_seen.h"
#include "lib/trace/solid_around.h"

namespace tempolux::tools {

LitFrame::LitFrame(SceneInput& input, int number, int camera, int width, int height)
    : number_(number), frame_(input.at(number)), view_(frame_, camera, width, height) {}

void LitFrame::build(SceneInput& input, StaticTree& tree, bool is_reference) {
  tracer_.emplace(frame_, tree);
  lights_.emplace(frame_, input.emission(frame_.frame));
  const SolidAround around(*tracer_);
  scene_.emplace(
      RenderScene{*tracer_, *lights_, !is_reference && lights_->has_suns(), Inside(around(view_.eye(), {}, 0))});
}

void LitFrame::guide_sky() {
  if (lights_->has_environment()) *lights_ = guided_lights(*scene_, view_);
}

void LitFrame::read_light(Tool& tool, const IndirectLightOptions& files, std::uint64_t seed) {
  light_ = std::make_unique<IndirectLight>(tool, files, *scene_, seed, number_);
}

}  // namespace tempolux::tools
