// lib/image/open_module.h -- loads modules on demand, so that tools need not link them.
#pragma once

#include <string>

namespace tempolux {

/// The address of `symbol` in the module `file`, which is loaded at its first use and stays loaded. Thread-safe. Throws
/// InputError if the module is not installed (installed_file(), which explains `purpose` and `remedy`) or damaged.
void* module_symbol(const char* file, const char* symbol, const std::string& purpose, const std::string& remedy);

}  // namespace tempolux
