// tests/cli/fail_write.cpp -- preloaded into a tool: the n-th call that writes to a file fails.
//     FAIL_COUNT=FILE          appends the number of such calls to FILE when the program ends
//     FAIL_AT=n FAIL_ERRNO=5   the n-th call (from 1) and all later ones fail with this errno: 5 EIO, 28 ENOSPC
// Counted: write, pwrite, writev, fsync and fdatasync on regular files, and rename.
#include <dlfcn.h>
#include <fcntl.h>
#include <sys/stat.h>
#include <sys/uio.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <cstdio>
#include <cstdlib>

namespace {

std::atomic<long> calls{0};

long number(const char* name) {
  const char* const text = std::getenv(name);
  return text ? std::atol(text) : 0;
}

/// Counts a call. Returns true and sets errno if it must fail.
bool fails() {
  static const long at = number("FAIL_AT"), error = number("FAIL_ERRNO");
  if (++calls < at || at <= 0) return false;
  errno = int(error);
  return true;
}

bool is_file(int descriptor) {
  struct stat facts;
  return fstat(descriptor, &facts) == 0 && S_ISREG(facts.st_mode);
}

template <class Function>
Function real(const char* name) {
  return reinterpret_cast<Function>(dlsym(RTLD_NEXT, name));
}

struct AtEnd {
  ~AtEnd() {
    if (const char* const path = std::getenv("FAIL_COUNT")) {
      char text[32];
      const int size = std::snprintf(text, sizeof text, "%ld\n", calls.load());
      const int file = open(path, O_WRONLY | O_CREAT | O_APPEND, 0666);
      if (file >= 0 && real<decltype(&::write)>("write")(file, text, std::size_t(size)) < 0) std::abort();
      close(file);
    }
  }
} at_end;

}  // namespace

extern "C" {

ssize_t write(int descriptor, const void* data, size_t size) {
  static const auto next = real<decltype(&::write)>("write");
  return is_file(descriptor) && fails() ? -1 : next(descriptor, data, size);
}
ssize_t pwrite(int descriptor, const void* data, size_t size, off_t offset) {
  static const auto next = real<decltype(&::pwrite)>("pwrite");
  return is_file(descriptor) && fails() ? -1 : next(descriptor, data, size, offset);
}
ssize_t writev(int descriptor, const iovec* parts, int count) {
  static const auto next = real<decltype(&::writev)>("writev");
  return is_file(descriptor) && fails() ? -1 : next(descriptor, parts, count);
}
int fsync(int descriptor) {
  static const auto next = real<decltype(&::fsync)>("fsync");
  return is_file(descriptor) && fails() ? -1 : next(descriptor);
}
int fdatasync(int descriptor) {
  static const auto next = real<decltype(&::fdatasync)>("fdatasync");
  return is_file(descriptor) && fails() ? -1 : next(descriptor);
}
int rename(const char* from, const char* to) {
  static const auto next = real<decltype(&::rename)>("rename");
  return fails() ? -1 : next(from, to);
}
}
