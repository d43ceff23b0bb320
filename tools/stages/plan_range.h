// tools/stages/plan_range.h -- scene-plan: turns the options into a wish, and plans a range of frames.
#pragma once

#include <string>
#include <vector>

#include "lib/plan/decisions.h"
#include "tools/common/tool_main.h"

namespace tempolux::tools {

/// Help text of scene-plan --shot.
inline constexpr const char* kShotHelp =
    "frames of the shot: they decide about light and kept pixels, whatever frames are asked for; without: all frames "
    "of the animation";

struct PlanOptions {
  std::string scene, folder = "out", estimate, quality = "final", method = "auto", filter = "auto", report, measured,
                     shot;
  std::vector<std::string> recipes, words;
  double aqm = -1;  ///< share of pixels in which a viewer may see errors; below 0: the preset's
  Wish wish;
};

/// Plans the frames of the run and writes the plan's folder, or the samples of an estimate. `arguments`: a hash of the
/// command; a folder whose plan was made by the same command from unchanged inputs stays as it is. `shot`: a hash of
/// the command without its frames. Throws InputError for options that contradict each other.
void plan_range(Tool& tool, const PlanOptions& options, const std::string& arguments, const std::string& shot);

}  // namespace tempolux::tools
