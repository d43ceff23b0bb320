#include "lib/core/machine_memory.h"

#include <unistd.h>

#include <algorithm>
#include <fstream>
#include <string>

namespace tempolux {
namespace {

/// The smallest limit among the group `path` and its parents below `mount`. A missing file, or the text "max", means no
/// limit.
std::uint64_t limit_of_groups(const std::string& mount, std::string path, const std::string& file) {
  std::uint64_t limit = ~0ull;
  for (;;) {
    std::uint64_t bytes = 0;
    if (std::ifstream(mount + path + "/" + file) >> bytes) limit = std::min(limit, bytes);
    if (path.empty()) return limit;
    path.erase(path.rfind('/'));
  }
}

/// Parses lines of /proc/self/cgroup: "NUMBER:CONTROLLERS:/PATH"; version 2 has no controllers.
std::uint64_t limit_of_this_process() {
  std::uint64_t limit = ~0ull;
  std::ifstream groups("/proc/self/cgroup");
  for (std::string line; std::getline(groups, line);) {
    const std::size_t first = line.find(':'), second = line.find(':', first + 1);
    if (second == std::string::npos || second + 1 >= line.size() || line[second + 1] != '/') continue;
    const std::string controllers = "," + line.substr(first + 1, second - first - 1) + ",";
    const std::string path = line.substr(second + 1) == "/" ? "" : line.substr(second + 1);
    if (controllers == ",,") limit = std::min(limit, limit_of_groups("/sys/fs/cgroup", path, "memory.max"));
    if (controllers.find(",memory,") != std::string::npos)
      limit = std::min(limit, limit_of_groups("/sys/fs/cgroup/memory", path, "memory.limit_in_bytes"));
  }
  return limit;
}

}  // namespace

std::uint64_t machine_memory() {
  const long pages = ::sysconf(_SC_PHYS_PAGES), page = ::sysconf(_SC_PAGE_SIZE);
  const std::uint64_t whole = pages > 0 && page > 0 ? std::uint64_t(pages) * std::uint64_t(page) : 1ull << 32;
  const std::uint64_t limit = limit_of_this_process();
  return limit > 0 ? std::min(whole, limit) : whole;
}

}  // namespace tempolux
