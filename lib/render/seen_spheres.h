// lib/render/seen_spheres.h -- where cameras look, as a few spheres on a lattice.
#pragma once

#include <vector>

#include "formats/plan/view.h"
#include "lib/light/lights.h"
#include "lib/render/camera_view.h"

namespace tempolux {

/// A place that a camera sees, or that such a place sees.
struct WeighedPlace {
  Vec3d position{};      ///< world space, m
  double weight = 0;     ///< 1 for what the eye sees, half as much at each bounce: surfaces reflect about half
  double distance = 0;   ///< m, from the eye; 0 of what was not seen directly
};

/// Adds what a camera sees of the scene that `tracer` holds at 48 x 27 stratified positions of its picture, through
/// mirrors and glass (seen_through), and after one and two cosine bounces. The same places for the same view: `number`
/// (of the view) keys the random numbers.
void add_seen_places(const Tracer& tracer, const CameraView& view, std::uint64_t number, std::vector<WeighedPlace>& places);

/// Spheres around cells of an octree whose cells have sizes and corners that are powers of two and their multiples: a
/// place that moves a little leaves them as they are. Cells that hold more than 1/32 of the weight are halved, the
/// heaviest first, while there are at most formats::kMaxViewSpheres, down to a quarter of the median distance from
/// which places are seen. Cells of less than 1/512 are left to the uniform photons. Weight: the cell's share, rounded
/// to a power of two.
///
/// None if they are not much smaller than the scene: if photons that are aimed at them (Aim) would not lie at least
/// twice as densely, in the geometric mean over places, as uniform ones on the disc of radius `scene_radius` [m].
/// Reasons: docs/methods/aim.md.
std::vector<formats::ViewSphere> spheres_around(const std::vector<WeighedPlace>& places, double scene_radius);

/// The spheres of a view, which are in world space, in a scene space of this origin [m].
std::vector<AimSphere> aim_spheres(const std::vector<formats::ViewSphere>& view, Vec3d origin);

/// Lights that send photons of sun and sky where the camera looks (docs/methods/aim.md).
Lights aimed_lights(const Tracer& tracer, EmissionTable table, const CameraView& view);

}  // namespace tempolux
