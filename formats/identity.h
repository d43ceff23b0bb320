// formats/identity.h -- which state of which scene a file belongs to (conventions.md, "Identity").
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace tempolux::formats {

/// Content hashes by concern, each as evaluated at the frame or over the interval for which the file is
/// valid; empty means unknown. Never the camera, seed, options or version.
struct Identity {
  std::string static_geometry, moving_geometry, materials, lights, media;
  int first_frame = 0, last_frame = -1;      ///< valid for these frames; last < first: no identity at all

  /// Of photons: hash of the frozen emission table, by which paths were chosen. Light that was recorded holds whatever it
  /// is; an update that replaces some of the paths needs the same.
  std::string emission{};

  bool known() const { return last_frame >= first_frame; }
  bool operator==(const Identity&) const = default;
};

/// Which concerns differ between what a file says and what the scene is, of those named in `concerns`
/// ("static_geometry", "moving_geometry", "materials", "lights", "media", "emission"; another: std::invalid_argument).
/// Unknown on either side never differs. Frames are not compared: which may differ, the reader knows.
std::vector<std::string> stale_concerns(const Identity& file, const Identity& scene,
                                        const std::vector<std::string_view>& concerns);

}  // namespace tempolux::formats
