// lib/core/module_folders.h -- folders with modules and child programs.
#pragma once

#include <string>
#include <vector>

namespace tempolux {

/// Folders to search for modules and child programs, in order of preference, relative to the running program
/// (/proc/self/exe): ../lib/tempolux and its variants for an installed program, ../modules in a build tree. The
/// environment is not read.
std::vector<std::string> default_module_folders();

/// Path of a module or child program that was installed or built with this program. Throws InputError "PURPOSE needs
/// NAME, which was not built or not installed (looked in ...); REMEDY".
std::string installed_file(const std::string& name, const std::string& purpose,
                           const std::string& remedy = "install all of tempolux together");

}  // namespace tempolux
