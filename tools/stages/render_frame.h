// tools/stages/render_frame.h -- frame-render: renders the frames of one scene.
#pragma once

#include <string>
#include <vector>

#include "lib/image/exr_io.h"
#include "lib/render/frame_renderer.h"
#include "tools/common/scene_input.h"
#include "tools/stages/indirect_light.h"
#include "tools/stages/still_moment.h"

namespace tempolux::tools {

struct RenderOptions {
  std::string scene, output, integrator = "auto", compression = "zip", mask, base;
  std::vector<std::string> channels{"RGBA", "Z", "N", "id"};
  FrameOptions frame;
  IndirectLightOptions light;
  StillOptions still;
  double pixel_error = -1;             ///< below 0: pixel_error_of_files if files hold the light, else 0
  double pixel_error_of_files = 0.01;  ///< relative error that a pixel may have
  bool half_float = false, keep_outliers = false;
  int width = 640, height = 360;
  double audit = 0;               ///< rays of the audit over rays of the frame (audit_effort)
  std::uint64_t light_paths = 0;  ///< of add_hidden_light

  ExrWriteOptions exr() const { return {half_float, compression == "zip"}; }
  bool traces_paths() const {
    return light.photons.empty() && light.irradcache.empty() && light.points.empty() && light.meshirrad.empty();
  }
};

/// Throws InputError for options that contradict each other, and sets the options that follow from others.
void check(const Tool& tool, RenderOptions& options);

/// Renders the frames of the run and writes their files.
void render_frames(Tool& tool, SceneInput& input, const RenderOptions& options);

}  // namespace tempolux::tools
