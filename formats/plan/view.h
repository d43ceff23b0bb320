// formats/plan/view.h -- state/SSSS-KEY.view: spheres around the surfaces that cameras see, openings through which
// light from outside reaches them, and the photons that each light gets (plan.md, "Views").
#pragma once

#include <array>
#include <cstdint>
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

/// The share of the photons that the lights of one node get.
struct ViewLight {
  static constexpr std::uint32_t kEnvironment = 0xffffffff;
  std::uint32_t node = kEnvironment;  ///< index of the glTF node with the light or the emissive mesh; or kEnvironment
  double share = 0;                   ///< above 0; the lights' shares are divided by their sum
};

inline constexpr std::size_t kMaxViewLights = 64;

struct View {
  std::vector<ViewSphere> spheres;  ///< empty: photons are not aimed at what is seen, and points lie everywhere
  /// Spheres through which useful light of sun and sky passes, such as parts of a window. Points ignore them.
  std::vector<ViewSphere> openings;
  std::vector<ViewLight> lights;  ///< empty: photons are shared out by flux
};

/// The text of the file: a line that names the format, then one line per sphere, per opening and per light. Reading the
/// numbers gives the same bits.
std::string view_text(const View& view);

/// Parses the text; `name` is the file's name in messages. Throws InputError with the line for another kind of file,
/// more than kMaxViewSpheres spheres or openings, more than kMaxViewLights, numbers that are not finite or above 1e30,
/// or a radius, weight or share that is not above 0.
View parse_view(const std::string& text, const std::string& name);

/// Reads and parses a file. Throws InputError also if the file cannot be read.
View read_view(const std::string& path);

}  // namespace tempolux::formats
