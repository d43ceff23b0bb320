// lib/core/module_folders.h -- where the parts of this program lie that are opened or started at need.
#pragma once

#include <string>
#include <vector>

namespace tempolux {

/// Folders in which modules and helper programs are looked for, best first, relative to the running program
/// (/proc/self/exe): ../lib/tempolux and its variants where it is installed, ../modules in a build tree. The
/// environment is not read.
std::vector<std::string> default_module_folders();

}  // namespace tempolux
