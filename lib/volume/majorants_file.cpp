#include "lib/volume/majorants_file.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <fstream>
#include <sstream>
#include <vector>

#include "formats/error.h"

namespace tempolux {
namespace {

constexpr const char* kFirstLine = "tempolux majorants 1.0";
constexpr std::size_t kLongestLine = 1 << 16;

std::string number(float value) {
  std::array<char, 32> text{};  // to_chars writes the shortest text that reads back as the same number
  const auto [end, error] = std::to_chars(text.data(), text.data() + text.size(), value);
  return {text.data(), end};
}

/// Reads the file line by line and keeps the line's number for messages.
class Lines {
 public:
  explicit Lines(const std::string& path) : path_(path), in_(path) {
    if (!in_) throw InputError(path + ": cannot be opened");
  }
  std::string next(const char* what) {
    std::string line;
    ++number_;
    for (char c; in_.get(c) && c != '\n';) {
      line += c;
      if (line.size() > kLongestLine) fail("too long");
    }
    if (line.empty() && !in_) fail(std::string("the file ends before ") + what);
    return line;
  }
  [[noreturn]] void fail(const std::string& what) const {
    throw InputError(path_ + ": line " + std::to_string(number_) + ": " + what + "; make it again with scene-plan");
  }
  /// Reads the numbers of a line "KEY a b c".
  template <class T>
  std::vector<T> values(const std::string& key, std::size_t count) {
    std::istringstream words(next(key.c_str()));
    std::string word;
    if (!(words >> word) || word != key) fail("is not '" + key + " ...'");
    std::vector<T> result;
    while (words >> word) result.push_back(parsed<T>(word));
    if (result.size() != count) fail(key + " has not " + std::to_string(count) + " numbers");
    return result;
  }
  template <class T>
  T parsed(const std::string& word) {
    T value{};
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
    if (error != std::errc{} || end != word.data() + word.size()) fail("'" + word.substr(0, 40) + "' is not a number");
    return value;
  }
  bool at_end() { return in_.peek() == std::ifstream::traits_type::eof(); }

 private:
  std::string path_;
  std::ifstream in_;
  std::size_t number_ = 0;
};

}  // namespace

std::string majorants_text(const FrozenMajorants& majorants) {
  const MajorantGrid& grid = majorants.grid;
  std::string text = std::string(kFirstLine) + "\nframes " + std::to_string(majorants.first_frame) + " " +
                     std::to_string(majorants.last_frame) + "\n";
  if (grid.empty()) return text + "cells 0 0 0\n";
  text += "cells";
  for (const std::int32_t n : grid.counts()) text += " " + std::to_string(n);
  for (const auto& [name, corner] : {std::pair{"\nlower", grid.box().lower}, std::pair{"\nupper", grid.box().upper}}) {
    text += name;
    for (int a = 0; a < 3; ++a) text += " " + number(corner[a]);
  }
  text += '\n';
  const auto along = std::size_t(grid.counts()[2]);
  for (std::size_t i = 0; i < grid.values().size(); ++i)
    text += number(grid.values()[i]) + ((i + 1) % along == 0 ? '\n' : ' ');
  return text;
}

FrozenMajorants load_majorants(const std::string& path) {
  Lines lines(path);
  if (lines.next("its first line") != kFirstLine) lines.fail(std::string("is not '") + kFirstLine + "'");
  const std::vector<int> frames = lines.values<int>("frames", 2);
  if (frames[0] > frames[1]) lines.fail("frames run backwards");
  FrozenMajorants majorants{frames[0], frames[1], {}};
  const std::vector<std::int32_t> cells = lines.values<std::int32_t>("cells", 3);
  if (cells == std::vector<std::int32_t>{0, 0, 0}) {
    if (!lines.at_end()) lines.fail("more after no cells");
    return majorants;
  }
  const std::vector<float> lower = lines.values<float>("lower", 3), upper = lines.values<float>("upper", 3);
  std::uint64_t count = 1;
  for (std::size_t a = 0; a < 3; ++a) {
    if (cells[a] < 1 || std::uint64_t(cells[a]) > MajorantGrid::kMostCells || !(std::abs(lower[a]) < 1e15f) ||
        !(upper[a] < 1e15f) || !(upper[a] > lower[a]))
      lines.fail("a box or numbers of cells that cannot be");
    if ((count *= std::uint64_t(cells[a])) > MajorantGrid::kMostCells) lines.fail("more than 2^21 cells");
  }
  MajorantGrid grid({{lower[0], lower[1], lower[2]}, {upper[0], upper[1], upper[2]}}, {cells[0], cells[1], cells[2]});
  for (std::size_t i = 0; i < grid.values().size();) {
    std::istringstream words(lines.next("all cells are there"));
    std::size_t in_line = 0;
    for (std::string word; words >> word; ++i, ++in_line) {
      if (in_line == std::size_t(cells[2])) lines.fail("more numbers than cells along z");
      const auto value = lines.parsed<float>(word);
      if (!(value >= 0) || !std::isfinite(value)) lines.fail("a majorant is negative or not finite");
      grid.values()[i] = value;
    }
    if (in_line != std::size_t(cells[2])) lines.fail("fewer numbers than cells along z");
  }
  if (!lines.at_end()) lines.fail("more after the last cell");
  majorants.grid = std::move(grid);
  return majorants;
}

MajorantGrid moved(const MajorantGrid& world, Vec3d origin) {
  if (world.empty() || origin == Vec3d{}) return world;
  MajorantGrid scene({Vec3(Vec3d(world.box().lower) - origin), Vec3(Vec3d(world.box().upper) - origin)},
                     world.counts());
  scene.values() = world.values();
  return scene;
}

}  // namespace tempolux
