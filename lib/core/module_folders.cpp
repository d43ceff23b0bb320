#include "lib/core/module_folders.h"

#include <filesystem>
#include <system_error>

#include "formats/error.h"

namespace tempolux {

std::vector<std::string> default_module_folders() {
  std::error_code error;
  const std::filesystem::path program = std::filesystem::read_symlink("/proc/self/exe", error);
  if (error) return {};
  const std::filesystem::path prefix = program.parent_path().parent_path();
  std::vector<std::string> folders;
  for (const char* folder : {"lib/tempolux", "lib/x86_64-linux-gnu/tempolux", "lib64/tempolux", "modules"})
    folders.push_back(prefix / folder);
  return folders;
}

std::string installed_file(const std::string& name, const std::string& purpose, const std::string& remedy) {
  std::string looked;
  for (const std::string& folder : default_module_folders()) {
    std::error_code ignored;
    if (std::filesystem::is_regular_file(folder + "/" + name, ignored)) return folder + "/" + name;
    looked += (looked.empty() ? "" : ", ") + folder;
  }
  throw InputError(purpose + " needs " + name + ", which was not built or not installed (looked in " + looked + "); " +
                   remedy);
}

}  // namespace tempolux
