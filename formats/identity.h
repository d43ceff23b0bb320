// formats/identity.h -- identifies the scene, and its state, to which a file belongs (conventions.md, "Identity").
#pragma once

#include <array>
#include <span>
#include <string>
#include <string_view>

namespace tempolux::formats {

/// Content hashes by concern, evaluated at the frame or over the interval for which the file is valid; empty:
/// unknown. Camera, seed, options and version are never part of an identity.
struct Identity {
  std::string static_geometry, moving_geometry, materials, lights, media;
  /// first and last frame for which the file is valid; last < first: there is no identity
  int first_frame = 0, last_frame = -1;

  /// Only for photons: hash of the emission table with which paths were chosen. A reader of the photons does not need
  /// it. An update that replaces some of the paths needs the same table.
  std::string emission{};

  bool known() const { return last_frame >= first_frame; }
  bool operator==(const Identity&) const = default;
};

/// The name of a concern, as in JSON and in attributes of frames. Header lines write - instead of _.
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
/// The concerns of the scene's state: all except `emission`.
inline constexpr std::span<const Concern> kSceneConcerns = std::span(kConcerns).first(5);

/// Names of the concerns in which a file differs from the scene, separated by ", ". A hash that is unknown on either
/// side does not count as different. Frames are not compared: the reader decides which frames may differ.
std::string stale_concerns(const Identity& file, const Identity& scene,
                           std::span<const Concern> concerns = kSceneConcerns);

}  // namespace tempolux::formats
