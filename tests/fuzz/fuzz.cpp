// tests/fuzz/fuzz.cpp
#include "tests/fuzz/fuzz.h"

#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>

#include "formats/crc32.h"

namespace tempolux::fuzz {
namespace {

namespace fs = std::filesystem;

struct Folder {
  fs::path path = (fs::exists("/dev/shm") ? fs::path("/dev/shm") : fs::temp_directory_path()) /
                  ("tempolux-fuzz-" + std::to_string(::getpid()));
  Folder() { fs::create_directories(path); }
  ~Folder() { fs::remove_all(path); }
};

[[noreturn]] void wrong(const std::string& what) {
  std::fprintf(stderr, "not as promised: %s\n", what.c_str());
  std::abort();
}

std::uint32_t word_at(const std::string& bytes, std::size_t at) {
  std::uint32_t word = 0;
  std::memcpy(&word, bytes.data() + at, sizeof word);
  return word;
}

void set_word(std::string& bytes, std::size_t at, std::uint32_t word) {
  std::memcpy(bytes.data() + at, &word, sizeof word);
}

constexpr std::string_view kMarks[] = {"PHOT", "LEDG", "IRPT", "IRRC", "RADP", "RADR", "RADS", "PATH", "MESH", "END!"};

std::size_t next_mark(const std::string& bytes, std::size_t from) {
  std::size_t next = bytes.size();
  for (const std::string_view mark : kMarks) next = std::min(next, bytes.find(mark, from));
  return next;
}

}  // namespace

std::string file_of(const std::uint8_t* data, std::size_t size, const std::string& extension) {
  static const Folder folder;
  static const std::string path = (folder.path / ("input" + extension)).string();
  std::FILE* file = std::fopen(path.c_str(), "wb");
  if (!file || std::fwrite(data, 1, size, file) != size || std::fclose(file) != 0) wrong("cannot write " + path);
  return path;
}

void expect_read_or_refused(const std::string& path, const std::function<void()>& read) {
  try {
    read();
  } catch (const InputError& error) {
    const std::string message = error.what();
    // A file may name another beside it.
    if (!message.starts_with(fs::path(path).parent_path().string())) wrong("names no file: " + message);
    if (message.find('\n') != std::string::npos) wrong("several lines: " + message);
    if (message.size() > 2000) wrong("a message of " + std::to_string(message.size()) + " bytes");
  }
}

std::string with_right_checksums(std::string bytes) {
  constexpr std::size_t kFixed = 16;
  if (bytes.size() < kFixed + 4) return bytes;
  const std::size_t text = word_at(bytes, 12);
  if (text > bytes.size() - kFixed - 4) return bytes;
  std::size_t at = kFixed + text;
  std::uint32_t chain = 0;
  const auto put_checksum = [&](std::size_t place, std::uint32_t crc) {
    set_word(bytes, place, crc);
    chain = formats::crc32(&crc, sizeof crc, chain);
  };
  put_checksum(at, formats::crc32(bytes.data(), at));
  for (at = next_mark(bytes, at + 4); at < bytes.size();) {
    const std::string_view mark = std::string_view(bytes).substr(at, 4);
    if (mark == "END!") {
      const std::size_t end = bytes.size() - 4;
      if (end >= at + 4) set_word(bytes, end, formats::crc32(bytes.data() + at, end - at, chain));
      break;
    }
    const std::size_t place = at + (mark == "PHOT" ? 12 : 8), next = next_mark(bytes, at + 4);
    if (place + 4 > next) break;
    put_checksum(place, formats::crc32(bytes.data() + place + 4, next - place - 4,
                                       formats::crc32(bytes.data() + at, place - at)));
    at = next;
  }
  return bytes;
}

}  // namespace tempolux::fuzz
