// tools/stages/warp_frames.h -- ibr-warp: makes frames from key frames.
#pragma once

#include <string>
#include <vector>

#include "lib/image/exr_io.h"
#include "tools/stages/warp_keys.h"

namespace tempolux::tools {

constexpr double kPixelsPerDegree = 30;  ///< of the display: 960 pixels across 32 degrees

struct WarpFramesOptions {
  std::vector<std::string> keys;
  std::string scene, view, output, flow, mask, compression = "zip";
  std::vector<std::string> channels{"Z", "N", "id"};
  WarpOptions warp{.slow_deg_per_s = -1};

  ExrWriteOptions exr() const { return {false, compression == "zip"}; }
};

/// Warps the keys to the frames of the scene.
void warp_frames(Tool& tool, const WarpFramesOptions& options, const std::vector<LoadedKey>& keys);
/// Warps the key frames to the camera and the surfaces that the frame `options.view` holds; reads no scene.
void warp_view(Tool& tool, const WarpFramesOptions& options, const std::vector<LoadedKey>& keys);

}  // namespace tempolux::tools
