// lib/aqm/display.h -- the display that shows a picture: luminance of its pixels, and pixels per degree of the eye.
#pragma once

#include <span>
#include <string>
#include <vector>

namespace tempolux::vision {

/// A display and its distance from the eye. Luminance in cd/m2.
struct Display {
  std::string name;
  double white = 0;  ///< luminance of value 1 after the exposure
  double peak = 0;   ///< largest luminance: >= white
  double black = 0;  ///< luminance of value 0: its own light and the reflected light of the room
  double pixels_per_degree = 0;
  double distance = 0;  ///< from the eye, metres
};

/// Displays by name: office, hdr, dark.
std::span<const Display> displays();
/// Throws InputError that lists the names.
Display display_named(const std::string& name);

/// black + (white - black) Y, at most peak. Y is the luminance of linear Rec. 709 values times `exposure`, each clipped
/// to what the display can show. `planes` are R, G, B or one plane of grey, of equal size. Infinite values are clipped;
/// NaN gives black.
std::vector<float> displayed_luminance(const Display& display, const std::vector<const std::vector<float>*>& planes,
                                       double exposure);

}  // namespace tempolux::vision
