// What a damaged JSON file is refused with.
#include "lib/core/json_file.h"

#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>
#include <string>

#include "formats/error.h"

namespace tempolux {
namespace {

class JsonFile : public testing::Test {
 protected:
  std::string written(const std::string& text) const {
    std::ofstream(name_) << text;
    return name_;
  }
  /// The message without the file's name.
  std::string refusal(const std::string& text) const {
    try {
      read_json(written(text));
    } catch (const InputError& error) { return std::string(error.what()).substr(name_.size()); }
    return "accepted";
  }

 private:
  std::string name_ = testing::TempDir() + "json_file_test.json";
};

TEST_F(JsonFile, KeepsTheOrderOfMembers) {
  EXPECT_EQ(read_json(written(R"({"b": 1, "a": [2, 3]})")).dump(), R"({"b":1,"a":[2,3]})");
}

TEST_F(JsonFile, RefusesWhatIsNoJson) {
  EXPECT_EQ(refusal("{"), ": byte 2: not JSON; make it anew");
  EXPECT_EQ(refusal(""), ": byte 1: not JSON; make it anew");
  EXPECT_EQ(refusal("[1e999]"), ": a number is too large for 64 bits of floating point");
}

TEST_F(JsonFile, RefusesDeepNesting) {
  EXPECT_EQ(refusal(std::string(32, '[') + std::string(32, ']')), "accepted");
  EXPECT_EQ(refusal(std::string(200000, '[')), ": nested deeper than 32 levels; this is no file of ours");
}

TEST_F(JsonFile, RefusesMissingFiles) { EXPECT_THROW(read_json("/nowhere/a.json"), InputError); }

// A manifest may name the empty string, which is its own folder. Seen to fail: the stream's own exception left.
TEST_F(JsonFile, RefusesFolders) { EXPECT_THROW(read_json(testing::TempDir()), InputError); }

}  // namespace
}  // namespace tempolux
