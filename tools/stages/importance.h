// tools/stages/importance.h -- where photons from afar are aimed and irradiance points are spread: --importance.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "formats/plan/view.h"
#include "tools/common/scene_input.h"

namespace tempolux::tools {

/// The help of the option, whose value is FILE, none or "" (what the tool finds itself).
inline constexpr const char* kImportanceHelp =
    "where photons of sun and sky are aimed and points lie closer together: a view file of scene-plan, "
    "state/FRAME-KEY.view; "
    "none: the whole scene; without it: what the camera sees over the frame's segment";

/// What cameras see, in world space, segment by segment.
class Importance {
 public:
  /// `option` as above. The scene must have a camera if it is "".
  Importance(Tool& tool, SceneInput& input, const std::string& option);
  /// Spheres for the segment that holds the frame; none: no aim.
  const std::vector<formats::ViewSphere>& at(int frame);

 private:
  Tool& tool_;
  SceneInput& input_;
  bool own_;  ///< found by this tool, as scene-plan finds it
  std::vector<formats::ViewSphere> given_;
  std::map<int, std::vector<formats::ViewSphere>> found_;  ///< by first frame of the segment
};

}  // namespace tempolux::tools
