// Majorants as text: files are read back with the same numbers, and damaged files are refused.
#include "lib/volume/majorants_file.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <fstream>

#include "formats/error.h"
#include "tests/formats/files.h"

namespace tempolux {
namespace {

std::string file_with(const std::string& text) {
  const std::string path =
      (std::filesystem::temp_directory_path() / ("majorants_" + std::to_string(::getpid()))).string();
  std::ofstream(path) << text;
  return path;
}

FrozenMajorants example() {
  FrozenMajorants majorants{0, 23, MajorantGrid({{-1, 0, 0.1f}, {1, 2, 0.7f}}, {2, 1, 3})};
  majorants.grid.values() = {0, 1.5f, 0.1f, 1e-30f, 7, std::nextafter(3.0f, 4.0f)};
  return majorants;
}

TEST(MajorantsFile, GivesTheSameNumbersBack) {
  const FrozenMajorants a = example(), b = load_majorants(file_with(majorants_text(a)));
  EXPECT_EQ(a.first_frame, b.first_frame);
  EXPECT_EQ(a.last_frame, b.last_frame);
  EXPECT_EQ(a.grid.hash(), b.grid.hash());
  const FrozenMajorants nothing = load_majorants(file_with(majorants_text({3, 4, {}})));
  EXPECT_TRUE(nothing.grid.empty());
  EXPECT_EQ(nothing.last_frame, 4);
}

TEST(MajorantsFile, WorkedExampleOfThePageIsWhatTheWriterWrites) {
  const std::string text = majorants_text(example());
  EXPECT_NE(formats::testing::load("../formats/majorants/majorants.md")
                .find("\n\n" + formats::testing::as_on_a_page(text) + "\n"),
            std::string::npos)
      << text;
}

TEST(MajorantsFile, RefusesWhatIsDamaged) {
  const std::string good = majorants_text(example());
  const auto replaced = [&](const std::string& a, const std::string& b) {
    std::string text = good;
    text.replace(text.find(a), a.size(), b);
    return text;
  };
  for (const std::string& text : {std::string(), replaced("1.0", "2.0"), replaced("frames 0 23", "frames 23 0"),
                                  replaced("cells 2 1 3", "cells 2 1"), replaced("cells 2 1 3", "cells 2 1 4"),
                                  replaced("cells 2 1 3", "cells 9999999 9999999 3"), replaced("upper 1", "upper -2"),
                                  replaced("upper 1", "upper nan"), replaced("1.5", "-1.5"), replaced("1.5", "inf"),
                                  replaced("1.5", "x"), good + "1\n", good.substr(0, good.size() / 2)})
    EXPECT_THROW(load_majorants(file_with(text)), InputError) << text;
  EXPECT_THROW(load_majorants("no/such/file"), InputError);
}

TEST(Majorants, AtAPoint) {
  const MajorantGrid grid = example().grid;
  EXPECT_EQ(grid.at({-0.5f, 1, 0.2f}), 0);
  EXPECT_EQ(grid.at({-0.5f, 1, 0.4f}), 1.5f);
  EXPECT_EQ(grid.at({1, 2, 0.7f}), std::nextafter(3.0f, 4.0f));
  EXPECT_EQ(grid.at({1.1f, 2, 0.7f}), 0);
}

}  // namespace
}  // namespace tempolux
