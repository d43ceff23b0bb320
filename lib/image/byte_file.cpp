#include "lib/image/byte_file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <string_view>
#include <utility>

#include "formats/error.h"

namespace tempolux {

ByteFile::ByteFile(std::string path) : path_(std::move(path)) {
  // O_NONBLOCK, since opening a pipe by mistake must give a message and not wait.
  descriptor_ = ::open(path_.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);
  if (descriptor_ < 0) throw InputError(path_ + ": cannot open: " + std::strerror(errno));
  struct stat status;
  if (::fstat(descriptor_, &status) != 0 || !S_ISREG(status.st_mode)) {
    ::close(descriptor_);
    throw InputError(path_ + ": not a regular file; a pipe or a folder cannot be read");
  }
  size_ = std::uint64_t(status.st_size);
}

ByteFile::~ByteFile() { ::close(descriptor_); }

void ByteFile::read_at(std::uint64_t offset, void* to, std::size_t count) const {
  char* next = static_cast<char*>(to);
  while (count > 0) {
    const ssize_t got = ::pread(descriptor_, next, count, off_t(offset));
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) throw ResourceError(path_ + ": cannot read: " + std::strerror(errno));
    if (got == 0)
      throw InputError(path_ + ": byte " + std::to_string(offset) + ": the file ends here, too early; write it again");
    next += got;
    offset += std::uint64_t(got);
    count -= std::size_t(got);
  }
}

void BufferedFile::read_at(std::uint64_t offset, void* to, std::size_t count) {
  // Offsets come from files, so sums with them may overflow. A read from the end on throws.
  if (count > file_.size() - std::min(offset, file_.size())) return file_.read_at(file_.size(), to, count);
  if (count == 0 || count >= buffer_.size()) return file_.read_at(offset, to, count);
  if (offset < start_ || offset + count > start_ + filled_) {
    start_ = offset;
    filled_ = std::size_t(std::min<std::uint64_t>(buffer_.size(), file_.size() - offset));
    file_.read_at(start_, buffer_.data(), filled_);
  }
  std::memcpy(to, buffer_.data() + (offset - start_), count);
}

void write_pieces(const std::string& path, std::span<const std::string> pieces) {
  const auto fail = [&](int error) { throw ResourceError(path + ": cannot write: " + std::strerror(error)); };
  const int descriptor = ::open(path.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
  if (descriptor < 0) fail(errno);
  for (std::string_view left : pieces) {
    while (!left.empty()) {
      const ssize_t done = ::write(descriptor, left.data(), left.size());
      if (done < 0 && errno == EINTR) continue;
      if (done < 0) {
        const int error = errno;
        ::close(descriptor);
        fail(error);
      }
      left.remove_prefix(std::size_t(done));
    }
  }
  if (::close(descriptor) != 0) fail(errno);
}

std::string one_line(const std::string& text) {
  std::string line = text.substr(0, 1024);
  std::replace_if(
      line.begin(), line.end(), [](char c) { return static_cast<unsigned char>(c) < 32; }, ' ');
  while (!line.empty() && (line.back() == ' ' || line.back() == '.')) line.pop_back();
  return line;
}

}  // namespace tempolux
