// tests/lib/image/image_fixture.h -- files in a folder that is removed afterwards, and an EXR writer that uses no
// library.
#pragma once

#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include "lib/image/image.h"

namespace tempolux {

/// A folder that is gone after the test.
class Folder {
 public:
  Folder()
      : path_(std::filesystem::temp_directory_path() /
              ("tempolux-image-" + std::to_string(getpid()) + "-" + unique())) {
    std::filesystem::create_directories(path_);
  }
  ~Folder() { std::filesystem::remove_all(path_); }
  std::string operator/(const std::string& name) const { return path_ / name; }

 private:
  static std::string unique() {
    static int count = 0;
    return std::to_string(count++);
  }
  std::filesystem::path path_;
};

inline std::string bytes_of(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}
inline void put_bytes(const std::string& path, const std::string& bytes) {
  std::ofstream(path, std::ios::binary | std::ios::trunc) << bytes;
}

/// The message of the exception that `run` throws, "" if it throws nothing of this kind.
template <class Error, class Run>
std::string message_of(Run run) {
  try {
    run();
  } catch (const Error& error) { return error.what(); }
  return "";
}

/// Little-endian bytes of a number.
template <class T>
std::string raw(T value) {
  return {reinterpret_cast<const char*>(&value), sizeof value};
}

/// Pieces of an OpenEXR file, as its file layout page has them.
namespace exr {

inline std::string z(const std::string& text) { return text + '\0'; }
inline std::string attribute(const std::string& name, const std::string& type, const std::string& value) {
  return z(name) + z(type) + raw(std::int32_t(value.size())) + value;
}
inline std::string box(int x0, int y0, int x1, int y1) { return raw(x0) + raw(y0) + raw(x1) + raw(y1); }
inline std::string channel(const std::string& name, int type, int sampling = 1) {
  return z(name) + raw(type) + raw(0) + raw(sampling) + raw(sampling);
}
/// Header attributes without the end; `channels` are in order of their names.
inline std::string header(const std::string& channels, const std::string& data, const std::string& display,
                          char compression = 0) {
  return attribute("channels", "chlist", channels + '\0') +
         attribute("compression", "compression", std::string(1, compression)) + attribute("dataWindow", "box2i", data) +
         attribute("displayWindow", "box2i", display) + attribute("lineOrder", "lineOrder", std::string(1, '\0')) +
         attribute("pixelAspectRatio", "float", raw(1.0f)) +
         attribute("screenWindowCenter", "v2f", raw(0.0f) + raw(0.0f)) +
         attribute("screenWindowWidth", "float", raw(1.0f));
}
inline std::string magic(std::uint32_t flags = 0) { return raw(std::uint32_t(20000630)) + raw(2u | flags); }

}  // namespace exr

}  // namespace tempolux
