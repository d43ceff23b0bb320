// lib/render/places_seen.h -- places that a camera sees, and places that these see: for pilots.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "lib/render/camera_view.h"
#include "lib/render/path_tracer.h"

namespace tempolux {

/// A place with a Lambert lobe, or none.
struct SeenPlace {
  SurfacePoint surface;
  Vec3 normal, geometric;  ///< on the side seen; zero vectors: nothing is there
  bool open = false;       ///< the ray that went on from here left the scene

  bool exists() const { return normal != Vec3{}; }
  bool sees(Vec3 wi) const { return dot(wi, geometric) > 0 && dot(wi, normal) > 0; }
};

struct SeenPlaces {
  std::vector<SeenPlace> places;  ///< by number of the eye ray: its first Lambert lobe, through mirrors and glass
  std::vector<SeenPlace> beyond;  ///< what a ray by the cosine met from there
};

/// Of what cameras see one after the other, scene space, the share that no camera before has seen: the mean over all
/// but the first, 0 for less than two. What mirrors and glass show is left out. `width`, `height`: of the pictures,
/// whose ratio counts.
double new_share(const Tracer& tracer, std::span<const PlacedCamera> cameras, int width, int height);

/// `looks` eye rays, stratified over the picture. Same places for any number of threads.
SeenPlaces places_seen(const RenderScene& scene, const CameraView& view, int looks, std::uint64_t seed);

}  // namespace tempolux
