// tools/stages/smoke_base.h -- reads what volume-compose needs of a frame: the base and the photons in media.
#pragma once

#include <string>

#include "lib/compose/compose.h"
#include "lib/image/image.h"
#include "tools/common/scene_input.h"

namespace tempolux::tools {

/// A frame that gets smoke.
struct SmokeBase {
  Image image;
  bool attenuated = true;     ///< its light is already attenuated by the smoke
  bool of_this_scene = true;  ///< it shows the scene's surfaces; else its channel Z says where smoke ends
};

/// Throws InputError if the base has smoke already, or shows another state of the scene or another view; warns if it
/// does not say what it shows, or was made without this smoke.
SmokeBase check_base(Tool& tool, const std::string& path, Image image, const SceneFrame& frame, const CameraView& view);

/// Adds the photons of the frame to the light of its media. Returns the file's history. Throws InputError for a map
/// that lacks the kinds or columns that the light needs.
std::string read_media_photons(Tool& tool, const std::string& path, const SceneFrame& frame, bool needs_direct,
                               MediaLight& light);

}  // namespace tempolux::tools
