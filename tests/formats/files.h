// tests/formats/files.h -- for the tests of all formats: scratch folders, bytes of files, what holds of every
// container.
#pragma once

#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iterator>
#include <sstream>
#include <string>

#include "formats/error.h"

namespace tempolux::formats::testing {

/// A folder of its own, removed at the end.
class Folder {
 public:
  Folder() {
    std::string name = (std::filesystem::temp_directory_path() / "formats_test.XXXXXX").string();
    if (!::mkdtemp(name.data())) throw std::runtime_error("no temporary folder");
    path_ = name;
  }
  ~Folder() { std::filesystem::remove_all(path_); }
  std::string operator/(const std::string& name) const { return path_ + "/" + name; }

 private:
  std::string path_;
};

inline void save(const std::string& path, const std::string& bytes) { std::ofstream(path, std::ios::binary) << bytes; }

/// The text with each line indented by four blanks, as pages show text files.
inline std::string as_on_a_page(const std::string& text) {
  std::string page;
  for (std::size_t begin = 0, end = 0; (end = text.find('\n', begin)) != text.npos; begin = end + 1)
    page += "    " + text.substr(begin, end + 1 - begin);
  return page;
}

inline std::string load(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

/// The bytes of a page's worked example: pairs of hexadecimal digits before two spaces.
inline std::string worked_example(const std::string& path) {
  std::istringstream page(load(path));
  std::string line, bytes;
  bool here = false;
  while (std::getline(page, line)) {
    if (line.rfind("## ", 0) == 0) here = line.find("Worked example") != line.npos;
    if (!here || line.rfind("    ", 0) != 0) continue;
    std::istringstream digits(line.substr(4, line.find("  ", 4) - 4));
    for (std::string word; digits >> word;)
      for (std::size_t i = 0; i + 1 < word.size(); i += 2) bytes += char(std::stoi(word.substr(i, 2), nullptr, 16));
  }
  return bytes;
}

/// Reads a file and checks it.
using Read = std::function<void(const std::string& path)>;

/// What reading these bytes says; "" if they are good.
inline std::string fault_of(const Folder& folder, const std::string& bytes, const Read& read) {
  const std::string path = folder / "x.file";
  std::filesystem::remove(path);  // some systems write a file to disk when it is replaced
  save(path, bytes);
  try {
    read(path);
    return "";
  } catch (const InputError& error) { return error.what(); }
}

inline void expect_every_truncation_refused(const std::string& whole, const Read& read) {
  const Folder folder;
  ASSERT_EQ(fault_of(folder, whole, read), "");
  for (std::size_t size = 0; size < whole.size(); ++size)
    EXPECT_NE(fault_of(folder, whole.substr(0, size), read), "") << "cut to " << size << " bytes";
}

inline void expect_every_flipped_bit_refused(const std::string& whole, const Read& read) {
  const Folder folder;
  for (std::size_t i = 0; i < whole.size(); ++i)
    for (int bit = 0; bit < 8; ++bit) {
      std::string broken = whole;
      broken[i] = char(broken[i] ^ (1 << bit));
      EXPECT_NE(fault_of(folder, broken, read), "") << "byte " << i << " bit " << bit;
    }
}

/// Reads every file of a folder, which must all be good or all be refused, and then for the reason that the
/// name gives: a sum or a checksum only where it says so. Returns how many there are.
inline int expect_files(const std::string& folder, bool good, const Read& read) {
  int count = 0;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    ++count;
    std::string fault;
    try {
      read(entry.path());
    } catch (const InputError& error) { fault = error.what(); }
    EXPECT_EQ(fault.empty(), good) << entry.path() << ": " << fault;
    const std::string name = entry.path().filename();
    const auto has = [](const std::string& text, const char* part) { return text.find(part) != text.npos; };
    const bool may_be_checksum =
        has(name, "checksum") || has(name, "block-") || has(name, "fewer") || has(name, "missing");
    EXPECT_TRUE(may_be_checksum || !has(fault, "checksum")) << fault;
    EXPECT_TRUE(has(name, "end-sum") || !has(fault, "not the sum")) << fault;
  }
  return count;
}

}  // namespace tempolux::formats::testing
