// tools/stages/base_frame.h -- what --mask and --base name: which pixels are traced, and where the others come from.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "lib/image/image.h"
#include "tools/common/scene_input.h"

namespace tempolux::tools {

struct BaseFrame {
  std::vector<std::uint8_t> mask;  ///< by pixel: is it traced? Empty: all are, and there is no base
  Image base;
};

/// What the picture to come looks like.
struct Picture {
  int width = 0, height = 0;
  std::array<double, 16> world_to_camera{}, world_to_ndc{};  ///< as in its attributes (frames.md 3)
};

/// Reads both. InputError if the mask has another size, or if the base shows another state of the scene
/// (check_identity) or was seen by another camera; with --allow-stale a warning.
BaseFrame read_base_frame(Tool& tool, const std::string& mask, const std::string& base, const SceneFrame& frame,
                          const Picture& picture);

}  // namespace tempolux::tools
