// tools/stages/base_frame.h -- reads --mask and --base: the pixels to trace, and the frame that gives the other pixels.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "lib/image/frame_identity.h"
#include "tools/common/scene_input.h"

namespace tempolux::tools {

struct BaseFrame {
  std::vector<std::uint8_t> mask;  ///< by pixel: 1 if it is traced. Empty: all pixels are traced, and there is no base
  Image base;
};

/// Size and camera of the picture to render.
struct Picture {
  int width = 0, height = 0;
  CameraMatrices camera;
};

/// Reads both files. Throws InputError if the mask has another size, or if the base shows another state of the scene
/// (check_identity) or has another camera; with --allow-stale these are warnings.
BaseFrame read_base_frame(Tool& tool, const std::string& mask, const std::string& base, const SceneFrame& frame,
                          const Picture& picture);

}  // namespace tempolux::tools
