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
    "view file of scene-plan, state/FRAME-KEY.view: photons of sun and sky are aimed at its spheres, points lie closer "
    "together there, and each light gets its share of the photons; none: no aim, and shares by flux; if not given: by "
    "what the camera sees over the frame's segment";

/// Spheres around what the cameras see, in world space, and shares of the lights, by segment.
class Importance {
 public:
  /// `option` as above. If it is "" the scene must have a camera. `kinds`: of the photons whose shares are wanted, as
  /// for PhotonOptions::set_kinds.
  Importance(Tool& tool, SceneInput& input, const std::string& option, std::string kinds);
  /// The view of the segment that holds the frame; empty: no aim.
  const formats::View& at(int frame);

 private:
  Tool& tool_;
  SceneInput& input_;
  bool own_;  ///< true if this tool finds the spheres, as scene-plan does
  std::string kinds_;
  formats::View given_;
  std::map<int, formats::View> found_;  ///< by first frame of the segment
};

}  // namespace tempolux::tools
