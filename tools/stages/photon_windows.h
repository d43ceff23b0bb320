// tools/stages/photon_windows.h -- the program gather-temporal density: light textures from the photons of many
// frames.
#pragma once

namespace tempolux::tools {

/// Light textures from the photons of many frames: docs/methods/density.md. Returns the exit code.
int photon_windows(int argc, char** argv);

}  // namespace tempolux::tools
