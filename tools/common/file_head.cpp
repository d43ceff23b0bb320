#include "tools/common/file_head.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>

#include "formats/error.h"

namespace tempolux::tools {
namespace {

constexpr std::size_t kHeadBytes = 16;

std::string head_of_stdin() {
  char bytes[kHeadBytes];
  ssize_t size = ::pread(STDIN_FILENO, bytes, sizeof bytes, std::max<off_t>(0, ::lseek(STDIN_FILENO, 0, SEEK_CUR)));
  int copy[2];
  if (size < 0 && ::pipe(copy) == 0) {
    size = ::tee(STDIN_FILENO, copy[1], sizeof bytes, 0);
    if (size > 0) size = ::read(copy[0], bytes, std::size_t(size));
    ::close(copy[0]);
    ::close(copy[1]);
  }
  return std::string(bytes, std::size_t(std::max<ssize_t>(size, 0)));
}

}  // namespace

std::string head_of(const std::string& path) {
  if (path == "-") return head_of_stdin();
  std::FILE* file = std::fopen(path.c_str(), "rb");
  if (!file) throw InputError(path + ": cannot be opened; is the name right?");
  char bytes[kHeadBytes] = {};
  const std::size_t size = std::fread(bytes, 1, sizeof bytes, file);
  std::fclose(file);
  return std::string(bytes, size);
}

std::string readable_name(const std::string& path) {
  struct stat info {};
  if (path == "-" || (::stat(path.c_str(), &info) == 0 && (S_ISREG(info.st_mode) || S_ISDIR(info.st_mode))))
    return path;
  const int file = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
  if (file < 0) throw InputError(path + ": cannot open: " + std::strerror(errno) + "; check the name");
  ::dup2(file, STDIN_FILENO);
  ::close(file);
  return "-";
}

}  // namespace tempolux::tools
