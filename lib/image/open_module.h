// lib/image/open_module.h -- shared objects that are opened at need, so that no tool pays for linking them.
#pragma once

#include <string>
#include <vector>

#include "lib/core/module_folders.h"

namespace tempolux {

/// The address of `symbol` in the module `file`, which is opened if this is its first use and stays. Thread-safe.
/// `purpose` begins every message, as "FILE: reading jpeg"; `remedy` ends the one for a module that is in none of the
/// folders. Throws InputError.
void* module_symbol(const char* file, const char* symbol, const std::vector<std::string>& folders,
                    const std::string& purpose, const std::string& remedy);

}  // namespace tempolux
