// lib/pilot/places_seen.h -- places that a camera sees, and places that these places see, for pilots.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "lib/render/camera_view.h"
#include "lib/render/path_tracer.h"
#include "lib/transport/learn_sky.h"

namespace tempolux {

/// Places of a picture that a pilot looks at. A share p of them is known to sqrt(p (1 - p) / 2048): 1.1 % at most.
inline constexpr int kPilotPlaces = 2048;
/// Places per camera of a pilot with several cameras: eight cameras together look at kPilotPlaces.
inline constexpr std::uint32_t kPlacesOfEye = kPilotPlaces / 8;
/// Parts of the picture whose light a pilot measures separately. 14 of its places lie in each.
inline constexpr int kPilotColumns = 16, kPilotRows = 9, kPilotParts = kPilotColumns * kPilotRows;
/// Index of the part at (x, y) in [0, 1)^2 of the picture.
inline std::size_t pilot_part(double x, double y) {
  return std::size_t(y * kPilotRows) * kPilotColumns + std::size_t(x * kPilotColumns);
}

/// Both lists have an element for each camera ray; SeenPlace::exists is false where the ray has no such place.
struct SeenPlaces {
  std::vector<SeenPlace> places;       ///< the first Lambert lobe that the camera ray meets, also by mirrors and glass
  std::vector<SeenPlace> next_places;  ///< the hit of one cosine-distributed ray from that place
};

/// The share of a camera's view that no earlier camera has seen, as the mean over all cameras but the first. Cameras
/// are in scene space. 0 for fewer than two cameras. Places behind mirrors and glass do not count. Only the ratio of
/// the picture's `width` and `height` matters.
double new_share(const Tracer& tracer, std::span<const PlacedCamera> cameras, int width, int height);

/// Follows `looks` camera rays, stratified over the picture. Positions are in scene space. Same places for any number
/// of threads.
SeenPlaces places_seen(const RenderScene& scene, const CameraView& view, int looks, std::uint64_t seed);

/// The scene's lights with a SkyGuide that has learned at kSkyPlaces places: half are SeenPlaces::places, half
/// next_places. The lights as they are if there is no environment.
Lights guided_lights(const RenderScene& scene, const CameraView& view);

}  // namespace tempolux
