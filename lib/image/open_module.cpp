#include "lib/image/open_module.h"

#include <dlfcn.h>

#include "formats/error.h"
#include "lib/core/module_folders.h"
#include "lib/image/byte_file.h"

namespace tempolux {

void* module_symbol(const char* file, const char* symbol, const std::string& purpose, const std::string& remedy) {
  const std::string path = installed_file(file, purpose, remedy);
  // A module is never unloaded. The loader counts repeated opens.
  void* module = ::dlopen(path.c_str(), RTLD_NOW | RTLD_LOCAL | RTLD_NODELETE);
  void* found = module ? ::dlsym(module, symbol) : nullptr;
  if (!found) throw InputError(purpose + ": " + path + ": " + one_line(::dlerror()));
  return found;
}

}  // namespace tempolux
