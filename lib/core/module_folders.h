// lib/core/module_folders.h -- folders with modules and child programs.
#pragma once

#include <string>
#include <vector>

namespace tempolux {

/// Folders to search for modules and child programs, in order of preference, relative to the running program
/// (/proc/self/exe): ../lib/tempolux and its variants for an installed program, ../modules in a build tree. The
/// environment is not read.
std::vector<std::string> default_module_folders();

}  // namespace tempolux
