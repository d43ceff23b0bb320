// tools/common/plan_views.h -- where the cameras of a plan look, for its photons.
#pragma once

#include "lib/plan/plan.h"
#include "tools/common/scene_input.h"

namespace tempolux::tools {

/// Fills plan.views, one for each group of segments that share photons (view_groups), from up to 16 of its pictures,
/// evenly spread: what their cameras see (lib/render/seen_spheres.h). None if no photons are needed: then no ray is traced. Under
/// lamps alone none either where the first picture tells of no spheres. `size`: of the pictures, pixels; their aspect counts.
void plan_views(SceneInput& input, int camera_node, int width, int height, Plan& plan);

}  // namespace tempolux::tools
