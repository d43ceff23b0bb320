// tools/stages/tidy.cpp -- finds and removes temporary files of dead processes.
#include "tools/stages/tidy.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <ctime>
#include <filesystem>
#include <optional>

#include "formats/error.h"
#include "tools/common/output.h"

namespace tempolux::tools {
namespace {

namespace fs = std::filesystem;

/// The process that wrote a temporary file, from its name.
struct Writer {
  std::string host;
  pid_t process = 0;
};

/// Parses ".NAME.tmp.HOST.PROCESS"; empty for any other name.
std::optional<Writer> writer_of(const std::string& name) {
  const std::size_t dot = name.rfind('.'), mark = name.rfind(".tmp.", dot);
  if (name.empty() || name[0] != '.' || mark == std::string::npos || mark < 2 || mark + 5 >= dot) return std::nullopt;
  const std::string digits = name.substr(dot + 1);
  if (digits.empty() || digits.size() > 9 || digits.find_first_not_of("0123456789") != std::string::npos)
    return std::nullopt;
  const pid_t process = pid_t(std::stol(digits));
  return process > 0 ? std::optional(Writer{name.substr(mark + 5, dot - mark - 5), process}) : std::nullopt;
}

/// True if no process holds the file's lock: Output locks the file that it writes.
bool is_unlocked(const std::string& path) {
  const int file = ::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NOFOLLOW);
  if (file < 0) return false;
  const bool free = ::flock(file, LOCK_EX | LOCK_NB) == 0;
  ::close(file);
  return free;
}

bool is_left_over(const std::string& path, const Writer& writer, const struct stat& status) {
  constexpr double kDay = 86400;  // s
  if (writer.host == temporary_host()) return ::kill(writer.process, 0) != 0 && errno == ESRCH && is_unlocked(path);
  return std::difftime(std::time(nullptr), status.st_mtime) > kDay && is_unlocked(path);
}

}  // namespace

Tidied tidy(const std::string& folder) {
  std::error_code error;
  fs::recursive_directory_iterator entries(folder, fs::directory_options::skip_permission_denied, error), end;
  if (error) throw InputError(folder + ": cannot be listed: " + error.message() + "; name a folder of outputs");
  Tidied tidied;
  for (; entries != end; entries.increment(error)) {
    if (error) throw ResourceError(folder + ": cannot be listed: " + error.message());
    const std::string path = entries->path().string();
    const std::optional<Writer> writer = writer_of(entries->path().filename().string());
    struct stat status {};
    if (!writer || ::lstat(path.c_str(), &status) != 0 || !S_ISREG(status.st_mode)) continue;
    if (!is_left_over(path, *writer, status)) {
      ++tidied.kept;
    } else if (::unlink(path.c_str()) == 0) {
      ++tidied.removed;
      tidied.bytes += std::uintmax_t(status.st_size);
    }
  }
  return tidied;
}

}  // namespace tempolux::tools
