// formats/identity.h -- which state of which scene a file belongs to (conventions.md, "Identity").
#pragma once

#include <array>
#include <span>
#include <string>
#include <string_view>

namespace tempolux::formats {

/// Content hashes by concern, each as evaluated at the frame or over the interval for which the file is
/// valid; empty means unknown. Never the camera, seed, options or version.
struct Identity {
  std::string static_geometry, moving_geometry, materials, lights, media;
  int first_frame = 0, last_frame = -1;  ///< valid for these frames; last < first: no identity at all

  /// Of photons: hash of the frozen emission table, by which paths were chosen. Light that was recorded holds whatever
  /// it is; an update that replaces some of the paths needs the same.
  std::string emission{};

  bool known() const { return last_frame >= first_frame; }
  bool operator==(const Identity&) const = default;
};

/// A concern by the name that JSON and attributes of frames have for it; header lines write - for _.
struct Concern {
  std::string_view name;
  std::string Identity::*hash;
};
inline constexpr std::array<Concern, 6> kConcerns{{{"static_geometry", &Identity::static_geometry},
                                                   {"moving_geometry", &Identity::moving_geometry},
                                                   {"materials", &Identity::materials},
                                                   {"lights", &Identity::lights},
                                                   {"media", &Identity::media},
                                                   {"emission", &Identity::emission}}};
/// Of the scene's state: all but the photons' emission.
inline constexpr std::span<const Concern> kSceneConcerns = std::span(kConcerns).first(5);

/// Which of `concerns` differ between what a file says and what the scene is: their names separated by ", ". Unknown on
/// either side never differs. Frames are not compared: which may differ, the reader knows.
std::string stale_concerns(const Identity& file, const Identity& scene,
                           std::span<const Concern> concerns = kSceneConcerns);

}  // namespace tempolux::formats
