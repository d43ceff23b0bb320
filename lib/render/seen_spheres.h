// lib/render/seen_spheres.h -- where cameras look, as a few spheres on a lattice.
#pragma once

#include <array>
#include <set>
#include <vector>

#include "formats/plan/view.h"
#include "lib/light/lights.h"
#include "lib/render/camera_view.h"

namespace tempolux {

/// A place that a camera sees, or that such a place sees.
struct WeighedPlace {
  Vec3d position{};     ///< world space, m
  double weight = 0;    ///< 1 for what the eye sees, half as much at each bounce: surfaces reflect about half
  double distance = 0;  ///< m, from the eye; 0 of what was not seen directly
};

/// What cameras and those around them see.
struct SeenAround {
  std::vector<WeighedPlace> places;
  std::set<std::array<double, 9>> looked;  ///< cells of the lattice of cameras that were looked from
};

/// Adds what a camera and those around it see of the scene that `tracer` holds: the same places for all cameras of a
/// cell of a lattice, so that a camera that moves or turns a little asks for no other photons. Of two cameras in one
/// cell the second adds nothing.
///
/// A cell is a cube of edge 2^k m, the largest that is neither longer than the median distance d from which surfaces
/// are seen nor than half the height h of the picture at that distance; directions lie in steps of a third of the angle
/// of view. Eyes are the middles of the cube's eight parts that the camera's own eye sees; their pictures are half as
/// wide again. Each looks at 24 x 14 stratified positions, through mirrors and glass (seen_through), and after one and
/// two cosine bounces. `width`, `height`: of the picture, whose ratio counts.
void look_around(const Tracer& tracer, const PlacedCamera& camera, int width, int height, SeenAround& seen);

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

/// The same in scene space; `origin`: that of the frame.
std::vector<AimSphere> spheres_in_scene(const std::vector<formats::ViewSphere>& view, Vec3d origin);

/// The spheres, in scene space, of what this camera and those around it see; `scene_radius`: m.
std::vector<AimSphere> spheres_seen(const Tracer& tracer, double scene_radius, const CameraView& view);

/// Lights that send photons of sun and sky where the camera looks (docs/methods/aim.md).
Lights aimed_lights(const Tracer& tracer, EmissionTable table, const CameraView& view);

}  // namespace tempolux
