// formats/plan/view.cpp -- reads and writes the view files of plan.md.
#include "formats/plan/view.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <fstream>
#include <sstream>
#include <string_view>

#include "formats/error.h"

namespace tempolux::formats {
namespace {

/// First lines of the versions. Version 1.1 adds lights, version 1.2 openings.
constexpr std::string_view kFirstLines[] = {"tempolux view 1.0", "tempolux view 1.1", "tempolux view 1.2"};
constexpr std::string_view kLight = "light ", kOpening = "opening ", kEnvironmentName = "environment";
constexpr double kFarthest = 1e30;             ///< m: squares stay in a double, and no scene is larger
constexpr std::size_t kLargestFile = 1 << 15;  ///< bytes: all lines with numbers of 24 characters need half

void append(std::string& text, double value, char after) {
  char digits[32];
  const auto end = std::to_chars(digits, digits + sizeof digits, value).ptr;
  text.append(digits, end).push_back(after);
}

[[noreturn]] void refuse(const std::string& name, std::size_t line, const std::string& why) {
  throw InputError(name + ": line " + std::to_string(line) + ": " + why + "; let scene-plan write the file anew");
}

/// Numbers at the end of a line, one blank or more before each. Refuses the line unless there are as many as in
/// `values`.
void parse_numbers(std::string_view line, std::span<double> values, const std::string& why, const std::string& name,
                   std::size_t number) {
  const char* at = line.data();
  const char* const end = at + line.size();
  for (double& value : values) {
    while (at != end && *at == ' ') ++at;
    const auto [next, error] = std::from_chars(at, end, value);
    if (error != std::errc() || !(std::abs(value) <= kFarthest)) refuse(name, number, why);
    at = next;
  }
  if (at != end) refuse(name, number, why);
}

void append(std::string& text, const ViewSphere& sphere) {
  for (const double x : sphere.centre) append(text, x, ' ');
  append(text, sphere.radius, ' ');
  append(text, sphere.weight, '\n');
}

ViewSphere parse_sphere(std::string_view line, const std::string& name, std::size_t number) {
  std::array<double, 5> values{};
  parse_numbers(line, values, "five numbers wanted: x y z radius weight", name, number);
  if (!(values[3] > 0) || !(values[4] > 0)) refuse(name, number, "radius and weight must be above 0");
  return {{values[0], values[1], values[2]}, values[3], values[4]};
}

ViewLight parse_light(std::string_view line, const std::string& name, std::size_t number) {
  const std::string wanted = "'light NODE SHARE' or 'light environment SHARE' wanted";
  line.remove_prefix(kLight.size());
  ViewLight light;
  if (line.starts_with(kEnvironmentName)) {
    line.remove_prefix(kEnvironmentName.size());
  } else {
    const auto [next, error] = std::from_chars(line.data(), line.data() + line.size(), light.node);
    if (error != std::errc() || light.node == ViewLight::kEnvironment) refuse(name, number, wanted);
    line.remove_prefix(std::size_t(next - line.data()));
  }
  parse_numbers(line, {&light.share, 1}, wanted, name, number);
  if (!(light.share > 0)) refuse(name, number, "a light's share must be above 0");
  return light;
}

}  // namespace

std::string view_text(const View& view) {
  const std::size_t version = !view.openings.empty() ? 2 : !view.lights.empty() ? 1 : 0;
  std::string text = std::string(kFirstLines[version]) + "\n";
  for (const ViewSphere& sphere : view.spheres) append(text, sphere);
  for (const ViewSphere& opening : view.openings) {
    text += kOpening;
    append(text, opening);
  }
  for (const ViewLight& light : view.lights) {
    text += kLight;
    text += light.node == ViewLight::kEnvironment ? std::string(kEnvironmentName) : std::to_string(light.node);
    text += ' ';
    append(text, light.share, '\n');
  }
  return text;
}

View parse_view(const std::string& text, const std::string& name) {
  std::istringstream in(text);
  std::string line;
  if (!std::getline(in, line) || std::ranges::count(kFirstLines, line) == 0)
    refuse(name, 1, "not a view file of version 1");
  const bool may_have_lights = line != kFirstLines[0], may_have_openings = line == kFirstLines[2];
  View view;
  for (std::size_t number = 2; std::getline(in, line); ++number) {
    if (may_have_lights && line.starts_with(kLight)) {
      if (view.lights.size() == kMaxViewLights)
        refuse(name, number, "more than " + std::to_string(kMaxViewLights) + " lights");
      view.lights.push_back(parse_light(line, name, number));
      continue;
    }
    const bool opening = may_have_openings && line.starts_with(kOpening);
    std::vector<ViewSphere>& list = opening ? view.openings : view.spheres;
    if (list.size() == kMaxViewSpheres)
      refuse(name, number, "more than " + std::to_string(kMaxViewSpheres) + (opening ? " openings" : " spheres"));
    list.push_back(parse_sphere(std::string_view(line).substr(opening ? kOpening.size() : 0), name, number));
  }
  return view;
}

View read_view(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  std::string text(kLargestFile + 1, '\0');
  in.read(text.data(), std::streamsize(text.size()));
  if (!in.is_open() || in.bad()) throw InputError(path + ": cannot read this view file; let scene-plan write it");
  text.resize(std::size_t(in.gcount()));
  if (text.size() > kLargestFile) throw InputError(path + ": too long for a view file; let scene-plan write it anew");
  return parse_view(text, path);
}

}  // namespace tempolux::formats
