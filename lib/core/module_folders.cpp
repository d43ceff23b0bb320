#include "lib/core/module_folders.h"

#include <filesystem>
#include <system_error>

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

}  // namespace tempolux
