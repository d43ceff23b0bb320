// Stamps of input files: which differences count as a change.
#include "lib/plan/inputs.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include <unistd.h>

namespace tempolux {
namespace {

namespace fs = std::filesystem;

class InputsTest : public testing::Test {
 protected:
  InputsTest() : folder(fs::temp_directory_path() / ("inputs_test." + std::to_string(::getpid()))) {
    fs::create_directories(folder);
  }
  ~InputsTest() override { fs::remove_all(folder); }
  std::string file(const std::string& name) const { return (folder / name).string(); }
  void write(const std::string& name, const std::string& text) const {
    std::ofstream(file(name), std::ios::binary) << text;
  }
  /// Notes these files as they are now.
  void note(const std::vector<std::string>& names, const std::string& wish = "wish") const {
    Inputs inputs("");
    for (const std::string& name : names) inputs.hash_of(file(name));
    write("noted", inputs.text(wish));
  }
  bool unchanged(const std::string& wish = "wish") const { return Inputs(file("noted")).unchanged(wish); }
  fs::path folder;
};

TEST_F(InputsTest, ContentCountsAndTimesDoNot) {
  write("a", "one");
  note({"a"});
  EXPECT_TRUE(unchanged());
  EXPECT_FALSE(unchanged("another wish"));
  fs::last_write_time(file("a"), fs::file_time_type::clock::now() - std::chrono::hours(2));
  EXPECT_TRUE(unchanged()) << "older, the same content";
  const auto time = fs::last_write_time(file("a"));
  write("a", "two");
  fs::last_write_time(file("a"), time);
  EXPECT_FALSE(unchanged()) << "the same size and time, other content: the inode's time is another";
}

TEST_F(InputsTest, AFileThatIsGoneOrAFolderThatGainsOneIsAChange) {
  write("a", "one");
  fs::create_directories(folder / "smoke");
  note({"a", "smoke"});
  write("smoke/0001.vdb", "x");
  EXPECT_FALSE(unchanged());
  note({"a", "smoke"});
  EXPECT_TRUE(unchanged());
  fs::remove(file("a"));
  EXPECT_FALSE(unchanged());
}

TEST_F(InputsTest, NamesMayHoldAnyCharacter) {
  for (const std::string name : {"a b", "line\nfeed", "$(x)", "tab\t", "1 2 3"}) write(name, name);
  note({"a b", "line\nfeed", "$(x)", "tab\t", "1 2 3"});
  EXPECT_TRUE(unchanged());
  write("line\nfeed", "other");
  EXPECT_FALSE(unchanged());
}

TEST_F(InputsTest, WhatIsNoSuchFileIsNoPlan) {
  for (const char* text :
       {"", "tempolux inputs 1", "tempolux inputs 1\nwish\n", "tempolux inputs 1\nwish\n1 2 3 4 hash 99999999 a\n"}) {
    write("noted", text);
    EXPECT_FALSE(unchanged()) << text;
  }
}

}  // namespace
}  // namespace tempolux
