// tools/stages/blur_frames.h -- st-filter blur: motion blur and depth of field for sharp frames.
#pragma once

namespace tempolux::tools {

/// main() of `st-filter blur`; argv[0] is the subcommand.
int blur_frames(int argc, char** argv);

}  // namespace tempolux::tools
