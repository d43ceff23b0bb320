// lib/render/places_seen.h -- places that a camera sees, and places that these places see, for pilots.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "lib/render/camera_view.h"
#include "lib/render/path_tracer.h"
#include "lib/transport/learn_sky.h"

namespace tempolux {

/// Places of a picture that a pilot looks at. A share p of them is known to sqrt(p (1 - p) / 2048): 1.1 % at most.
inline constexpr int kPilotPlaces = 2048;
/// Places of a pilot that looks from many eyes: eight eyes together look at kPilotPlaces.
inline constexpr std::uint32_t kPlacesOfEye = kPilotPlaces / 8;
/// Parts of the picture that a pilot measures apart: 14 of its places lie in each.
inline constexpr int kPilotColumns = 16, kPilotRows = 9;

struct SeenPlaces {
  std::vector<SeenPlace> places;  ///< by index of the camera ray: its first Lambert lobe, through mirrors and glass
  std::vector<SeenPlace> next_places;  ///< the place that a cosine-distributed ray from there met
};

/// For cameras one after the other: the share of each camera's view that no camera before has seen, as the mean over
/// all but the first. 0 for fewer than two cameras. Scene space. Mirrors and glass are not followed. Only the ratio of
/// `width` and `height`, those of the pictures, counts.
double new_share(const Tracer& tracer, std::span<const PlacedCamera> cameras, int width, int height);

/// Follows `looks` camera rays, stratified over the picture. Same places for any number of threads.
SeenPlaces places_seen(const RenderScene& scene, const CameraView& view, int looks, std::uint64_t seed);

/// The scene's lights with a SkyGuide. The guide learns at two sets of places: where camera rays end, and where one
/// cosine-distributed ray from each of these places ends.
Lights guided_lights(const RenderScene& scene, const CameraView& view);

}  // namespace tempolux
