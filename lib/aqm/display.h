// lib/aqm/display.h -- the display that a picture is looked at on: luminance of its pixels, pixels in a
// degree of the eye.
#pragma once

#include <span>
#include <string>
#include <vector>

namespace tempolux::vision {

/// A display and where it stands. Luminance in cd/m2.
struct Display {
  std::string name;
  double white = 0;  ///< luminance of value 1 after the exposure
  double peak = 0;   ///< largest luminance: >= white
  double black = 0;  ///< luminance of value 0: its own light and what of the room's it reflects
  double pixels_per_degree = 0;
  double distance = 0;  ///< of the eye, metres
};

/// Displays by name: office, hdr, dark.
std::span<const Display> displays();
/// Throws InputError that lists the names.
Display display_named(const std::string& name);

/// black + (white - black) Y, at most peak; Y the luminance of linear Rec. 709 values times `exposure`, each
/// clipped at 0 and at what the display can show. `planes` are R, G, B or one plane of grey, of equal size.
/// Infinite values are clipped; not-a-number gives black.
std::vector<float> displayed_luminance(const Display& display, const std::vector<const std::vector<float>*>& planes,
                                       double exposure);

}  // namespace tempolux::vision
