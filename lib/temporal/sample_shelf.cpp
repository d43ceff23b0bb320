#include "lib/temporal/sample_shelf.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <utility>

#include "formats/error.h"

namespace tempolux {
namespace {

constexpr std::size_t kSample = sizeof(formats::RadianceSample), kAnchor = sizeof(std::uint32_t);

[[noreturn]] void fail(const std::string& folder, const char* what, int error) {
  throw ResourceError("samples that --max-memory keeps in a file in " + folder + ": " + what + ": " +
                      std::strerror(error) + "; make room there, or raise --max-memory");
}

/// Opens a file without a name, which the system removes when it is closed.
int open_nameless(const std::string& folder) {
  int file = open(folder.c_str(), O_TMPFILE | O_RDWR | O_CLOEXEC, 0600);
  if (file >= 0) return file;
  if (errno != EOPNOTSUPP && errno != EISDIR && errno != EINVAL && errno != ENOENT)
    fail(folder, "cannot create it", errno);
  std::string name = folder + "/.samples.tmp.XXXXXX";  // for file systems without nameless files
  file = mkostemp(name.data(), O_CLOEXEC);
  if (file < 0) fail(folder, "cannot create it", errno);
  unlink(name.c_str());
  return file;
}

/// Transfers all bytes. Returns -1 with errno after an error, 0 if the file ends too early.
template <class Byte, class Transfer>
int transfer_all(int file, Byte* data, std::size_t size, std::int64_t at, const Transfer& transfer) {
  while (size > 0) {
    const ssize_t done = transfer(file, data, size, at);
    if (done < 0 && errno == EINTR) continue;
    if (done <= 0) return int(done);
    data += done, size -= std::size_t(done), at += done;
  }
  return 1;
}

}  // namespace

SampleShelf::SampleShelf(std::string folder, std::uint64_t limit) : folder_(std::move(folder)), limit_(limit) {}

SampleShelf::~SampleShelf() {
  if (file_ >= 0) close(file_);
}

std::int64_t SampleShelf::free_place(std::size_t count) {
  const std::lock_guard lock(mutex_);
  if (file_ < 0) file_ = open_nameless(folder_);
  if (const auto some = free_.find(count); some != free_.end() && !some->second.empty()) {
    const std::int64_t place = some->second.back();
    some->second.pop_back();
    return place;
  }
  return std::exchange(end_, end_ + std::int64_t(count * (kSample + kAnchor)));
}

void SampleShelf::put(Place& place, std::vector<formats::RadianceSample>& samples,
                      std::vector<std::uint32_t>& anchors) {
  const std::size_t count = samples.size(), bytes = count * (kSample + kAnchor);
  if (!place.on_disk()) {
    if (place.counted) return;
    if (in_memory_.fetch_add(bytes) + bytes <= limit_) {
      place.counted = true;
      return;
    }
    in_memory_ -= bytes;
    place.offset = free_place(count);
  }
  const auto write = [](int file, const char* data, std::size_t size, std::int64_t at) {
    return pwrite(file, data, size, at);
  };
  if (transfer_all(file_, reinterpret_cast<const char*>(samples.data()), count * kSample, place.offset, write) < 0 ||
      transfer_all(file_, reinterpret_cast<const char*>(anchors.data()), count * kAnchor,
                   place.offset + std::int64_t(count * kSample), write) < 0)
    fail(folder_, "write failed", errno);
  let_go(place, samples, anchors);
}

void SampleShelf::fetch(std::size_t count, const Place& place, std::vector<formats::RadianceSample>& samples,
                        std::vector<std::uint32_t>& anchors) const {
  if (!place.on_disk()) return;
  samples.resize(count), anchors.resize(count);
  const auto read = [](int file, char* data, std::size_t size, std::int64_t at) { return pread(file, data, size, at); };
  errno = EIO;  // the file ended too early
  if (transfer_all(file_, reinterpret_cast<char*>(samples.data()), count * kSample, place.offset, read) <= 0 ||
      transfer_all(file_, reinterpret_cast<char*>(anchors.data()), count * kAnchor,
                   place.offset + std::int64_t(count * kSample), read) <= 0)
    fail(folder_, "read failed", errno);
}

void SampleShelf::let_go(const Place& place, std::vector<formats::RadianceSample>& samples,
                         std::vector<std::uint32_t>& anchors) const {
  if (!place.on_disk()) return;
  std::vector<formats::RadianceSample>().swap(samples);
  std::vector<std::uint32_t>().swap(anchors);
}

void SampleShelf::give_up(std::size_t count, Place& place) {
  if (place.on_disk()) {
    const std::lock_guard lock(mutex_);
    free_[count].push_back(place.offset);
  } else if (place.counted) {
    in_memory_ -= count * (kSample + kAnchor);
  }
  place = {};
}

}  // namespace tempolux
