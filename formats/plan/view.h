// formats/plan/view.h -- state/SSSS-KEY.view: spheres around the surfaces that cameras see (plan.md, "Views").
#pragma once

#include <array>
#include <span>
#include <string>
#include <vector>

namespace tempolux::formats {

struct ViewSphere {
  std::array<double, 3> centre{};  ///< world space, m
  double radius = 0;               ///< m, above 0
  double weight = 0;               ///< above 0; a sphere's share is its weight divided by the sum of all weights
};

inline constexpr std::size_t kMaxViewSpheres = 32;

/// The text of the file: a line that names the format, then one line per sphere. Reading the numbers gives the same
/// bits.
std::string view_text(std::span<const ViewSphere> spheres);

/// Parses the text; `name` is the file's name in messages. Throws InputError with the line for another kind of file,
/// more than kMaxViewSpheres, numbers that are not finite or above 1e30, or a radius or weight that is not above 0.
std::vector<ViewSphere> parse_view(const std::string& text, const std::string& name);

/// Reads and parses a file. Throws InputError also if the file cannot be read.
std::vector<ViewSphere> read_view(const std::string& path);

}  // namespace tempolux::formats
