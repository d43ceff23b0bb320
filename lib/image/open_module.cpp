#include "lib/image/open_module.h"

#include <dlfcn.h>

#include <filesystem>
#include <system_error>

#include "formats/error.h"
#include "lib/image/byte_file.h"

namespace tempolux {

void* module_symbol(const char* file, const char* symbol, const std::vector<std::string>& folders,
                    const std::string& purpose, const std::string& remedy) {
  std::string looked;
  for (const std::string& folder : folders) {
    const std::string path = folder + "/" + file;
    looked += (looked.empty() ? "" : ", ") + folder;
    std::error_code ignored;
    if (!std::filesystem::exists(path, ignored)) continue;
    // Never unloaded: OpenImageIO's libraries crash if they are. The loader counts repeated opens.
    void* module = ::dlopen(path.c_str(), RTLD_NOW | RTLD_LOCAL | RTLD_NODELETE);
    void* found = module ? ::dlsym(module, symbol) : nullptr;
    if (!found) throw InputError(purpose + ": " + path + ": " + one_line(::dlerror()));
    return found;
  }
  throw InputError(purpose + " needs " + file + ", which was not built or not installed (looked in " + looked + "); " +
                   remedy);
}

}  // namespace tempolux
