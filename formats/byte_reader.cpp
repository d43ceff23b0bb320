#include "formats/byte_reader.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>

#include "formats/error.h"

namespace tempolux::formats {
namespace {

constexpr std::size_t kBufferSize = 32 << 10;  // small, since bytes in the buffer are copied twice

std::string reason_of(int error) { return std::strerror(error); }

}  // namespace

ByteReader::ByteReader(const std::string& path) : name_(path == "-" ? "<stdin>" : path), buffer_(kBufferSize) {
  file_ = path == "-" ? STDIN_FILENO : ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
  if (file_ < 0) throw InputError(name_ + ": cannot open: " + reason_of(errno) + "; check the name");
  struct stat info {};
  if (::fstat(file_, &info) == 0 && S_ISREG(info.st_mode)) {
    const off_t start = std::max(off_t(0), ::lseek(file_, 0, SEEK_CUR));
    known_size_ = true;
    size_ = std::uint64_t(std::max(off_t(0), info.st_size - start));
  } else if (S_ISDIR(info.st_mode)) {
    ::close(file_);
    throw InputError(name_ + ": is a folder; give a file");
  }
}

ByteReader::~ByteReader() {
  if (file_ != STDIN_FILENO) ::close(file_);
}

std::size_t ByteReader::read_some(void* data, std::size_t size) {
  for (;;) {
    const ssize_t got = ::read(file_, data, std::min(size, std::size_t(1) << 30));
    if (got >= 0) return std::size_t(got);
    if (errno != EINTR) throw ResourceError(name_ + ": cannot read: " + reason_of(errno));
  }
}

void ByteReader::read(void* data, std::size_t size, const char* what) {
  auto* out = static_cast<unsigned char*>(data);
  std::size_t done = 0;
  while (done < size) {
    if (buffer_first_ == buffer_last_ && size - done < kBufferSize) {
      buffer_first_ = 0;
      buffer_last_ = read_some(buffer_.data(), kBufferSize);
      if (buffer_last_ == 0) break;
    }
    const std::size_t buffered = std::min(size - done, buffer_last_ - buffer_first_);
    if (buffered > 0) {
      std::memcpy(out + done, buffer_.data() + buffer_first_, buffered);
      buffer_first_ += buffered;
      done += buffered;
    } else {
      const std::size_t got = read_some(out + done, size - done);
      if (got == 0) break;
      done += got;
    }
  }
  if (done < size) fail(offset_ + done, std::string("ends inside ") + what, "the file is incomplete: make it again");
  offset_ += size;
}

void ByteReader::expect(std::uint64_t size, const char* what) {
  if (known_size_ && (offset_ > size_ || size > size_ - offset_))
    fail(offset_,
         std::string("ends inside ") + what + ": " + std::to_string(size) + " bytes should follow, " +
             std::to_string(size_ - std::min(size_, offset_)) + " are left",
         "the file is incomplete: make it again");
}

void ByteReader::expect_end() {
  unsigned char byte;
  const bool more = buffer_first_ < buffer_last_ || read_some(&byte, 1) > 0;
  if (more) fail(offset_, "bytes after the end block");
}

void ByteReader::fail(std::uint64_t offset, const std::string& reason) const {
  fail(offset, reason, "the file is damaged: make it again");
}

void ByteReader::fail(std::uint64_t offset, const std::string& reason, const std::string& remedy) const {
  throw InputError(name_ + ": byte " + std::to_string(offset) + ": " + reason + "; " + remedy);
}

}  // namespace tempolux::formats
