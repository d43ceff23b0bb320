// formats/plan/view.h -- state/SSSS-KEY.view: the spheres that hold what cameras see (plan.md, "Views").
#pragma once

#include <array>
#include <span>
#include <string>
#include <vector>

namespace tempolux::formats {

struct ViewSphere {
  std::array<double, 3> centre{};  ///< world space, m
  double radius = 0;               ///< m, above 0
  double weight = 0;               ///< above 0; shares are weight / sum of weights
};

inline constexpr std::size_t kMaxViewSpheres = 32;

/// The file's text: a line that names the format, then a line per sphere; numbers that read back to the same bits.
std::string view_text(std::span<const ViewSphere> spheres);

/// Reads the text; `name` is the file's in messages. InputError, with the line, for what is no view file, more than
/// kMaxViewSpheres, numbers that are not finite or beyond 1e30, or a radius or weight that is not above 0.
std::vector<ViewSphere> parse_view(const std::string& text, const std::string& name);

/// The same of a file. InputError if it cannot be read.
std::vector<ViewSphere> read_view(const std::string& path);

}  // namespace tempolux::formats
