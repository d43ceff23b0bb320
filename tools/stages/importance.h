// tools/stages/importance.h -- --importance: where photons of distant light are aimed and irradiance points are spread.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "formats/plan/view.h"
#include "tools/common/scene_input.h"

namespace tempolux::tools {

/// Help of the option, whose value is FILE, none or "" (spheres found by the tool).
inline constexpr const char* kImportanceHelp =
    "view file of scene-plan, state/FRAME-KEY.view: photons of sun and sky are aimed at its spheres, and points lie "
    "closer together there; none: no aim; if not given: the surfaces that the camera sees over the frame's segment";

/// Spheres around what the cameras see, in world space, by segment.
class Importance {
 public:
  /// `option` as above. If it is "" the scene must have a camera.
  Importance(Tool& tool, SceneInput& input, const std::string& option);
  /// Spheres for the segment that holds the frame; empty: no aim.
  const std::vector<formats::ViewSphere>& at(int frame);

 private:
  Tool& tool_;
  SceneInput& input_;
  bool own_;  ///< true if this tool finds the spheres, as scene-plan does
  std::vector<formats::ViewSphere> given_;
  std::map<int, std::vector<formats::ViewSphere>> found_;  ///< by first frame of the segment
};

}  // namespace tempolux::tools
