// formats/plan/view.cpp -- reads and writes the view files of plan.md.
#include "formats/plan/view.h"

#include <charconv>
#include <cmath>
#include <fstream>
#include <sstream>
#include <string_view>

#include "formats/error.h"

namespace tempolux::formats {
namespace {

constexpr std::string_view kFirstLine = "tempolux view 1.0";
constexpr double kFarthest = 1e30;             ///< m: squares stay in a double, and no scene is larger
constexpr std::size_t kLargestFile = 1 << 14;  ///< bytes: 32 lines of five numbers of 24 characters need a quarter

void append(std::string& text, double value, char after) {
  char digits[32];
  const auto end = std::to_chars(digits, digits + sizeof digits, value).ptr;
  text.append(digits, end).push_back(after);
}

[[noreturn]] void refuse(const std::string& name, std::size_t line, const std::string& why) {
  throw InputError(name + ": line " + std::to_string(line) + ": " + why + "; let scene-plan write the file anew");
}

ViewSphere parse_line(std::string_view line, const std::string& name, std::size_t number) {
  std::array<double, 5> values{};
  const char* at = line.data();
  const char* const end = at + line.size();
  for (double& value : values) {
    while (at != end && *at == ' ') ++at;
    const auto [next, error] = std::from_chars(at, end, value);
    if (error != std::errc() || !(std::abs(value) <= kFarthest))
      refuse(name, number, "five numbers wanted: x y z radius weight");
    at = next;
  }
  if (at != end) refuse(name, number, "five numbers wanted: x y z radius weight");
  if (!(values[3] > 0) || !(values[4] > 0)) refuse(name, number, "radius and weight must be above 0");
  return {{values[0], values[1], values[2]}, values[3], values[4]};
}

}  // namespace

std::string view_text(std::span<const ViewSphere> spheres) {
  std::string text = std::string(kFirstLine) + "\n";
  for (const ViewSphere& sphere : spheres) {
    for (const double x : sphere.centre) append(text, x, ' ');
    append(text, sphere.radius, ' ');
    append(text, sphere.weight, '\n');
  }
  return text;
}

std::vector<ViewSphere> parse_view(const std::string& text, const std::string& name) {
  std::istringstream in(text);
  std::string line;
  if (!std::getline(in, line) || line != kFirstLine) refuse(name, 1, "not a view file of version 1");
  std::vector<ViewSphere> spheres;
  for (std::size_t number = 2; std::getline(in, line); ++number) {
    if (spheres.size() == kMaxViewSpheres)
      refuse(name, number, "more than " + std::to_string(kMaxViewSpheres) + " spheres");
    spheres.push_back(parse_line(line, name, number));
  }
  return spheres;
}

std::vector<ViewSphere> read_view(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  std::string text(kLargestFile + 1, '\0');
  in.read(text.data(), std::streamsize(text.size()));
  if (!in.is_open() || in.bad()) throw InputError(path + ": cannot read this view file; let scene-plan write it");
  text.resize(std::size_t(in.gcount()));
  if (text.size() > kLargestFile) throw InputError(path + ": too long for a view file; let scene-plan write it anew");
  return parse_view(text, path);
}

}  // namespace tempolux::formats
