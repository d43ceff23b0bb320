// tools/stages/compose_smoke.h -- what volume-compose does with a frame.
#pragma once

#include <string>

#include "lib/compose/compose.h"
#include "lib/compose/smoke_layer.h"
#include "tools/common/scene_input.h"

namespace tempolux::tools {

/// Options of volume-compose. Names may be patterns.
struct SmokeOptions {
  std::string scene, photons, points, base, output, direct = "rays";
  MediaLight::Options light;
  ComposeOptions compose;
  bool half_float = false;
};

/// Puts the smoke of a frame into its base, and writes the picture. `tree`: of the frame before, for the next one.
void compose_smoke(Tool& tool, SceneInput& input, SmokeOptions options, int number, StaticTree& tree);

}  // namespace tempolux::tools
