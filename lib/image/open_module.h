// lib/image/open_module.h -- loads modules on demand, so that tools need not link them.
#pragma once

#include <string>
#include <vector>

#include "lib/core/module_folders.h"

namespace tempolux {

/// The address of `symbol` in the module `file`, which is loaded at its first use and stays loaded. Thread-safe.
/// `purpose` begins every message, as in "FILE: reading jpeg"; `remedy` ends the message for a module that is in none
/// of the folders. Throws InputError.
void* module_symbol(const char* file, const char* symbol, const std::vector<std::string>& folders,
                    const std::string& purpose, const std::string& remedy);

}  // namespace tempolux
