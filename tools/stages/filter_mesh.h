// tools/stages/filter_mesh.h -- st-filter mesh: light textures from photons.
#pragma once

namespace tempolux::tools {

/// The program `st-filter mesh`; argv[0] is "mesh". Returns the exit code.
int filter_mesh(int argc, char** argv);

}  // namespace tempolux::tools
