// tools/stages/audit_input.h -- photons for the audit of a frame: read block by block.
#pragma once

#include <string>
#include <vector>

#include "lib/render/audit.h"
#include "tools/common/scene_input.h"

namespace tempolux::tools {

/// One global map, or a static and a dynamic one (names or patterns). InputError if they are not of this
/// state of the scene, or parts without the rest.
AuditPhotons audit_photons(Tool& tool, const std::vector<std::string>& files, const SceneFrame& frame, int number);

}  // namespace tempolux::tools
