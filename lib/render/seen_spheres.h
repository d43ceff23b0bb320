// lib/render/seen_spheres.h -- spheres on a lattice around the places that cameras see, at which photons are aimed.
#pragma once

#include <array>
#include <set>
#include <vector>

#include "formats/plan/view.h"
#include "lib/light/lights.h"
#include "lib/render/camera_view.h"

namespace tempolux {

/// A place that a camera sees, or that a path from such a place reaches.
struct WeighedPlace {
  Vec3d position{};     ///< world space, m
  double weight = 0;    ///< 1 for a place that the camera sees, halved at each bounce: surfaces reflect about half
  double distance = 0;  ///< from the camera [m]; 0 after a bounce
};

/// Places that look_around() has found.
struct SeenAround {
  std::vector<WeighedPlace> places;
  std::set<std::array<double, 9>> looked;  ///< cells of the lattice of cameras whose places were added
};

/// Adds the places that representatives of a camera see. A lattice divides all cameras into cells, and all cameras of
/// one cell have the same representatives. So a camera that moves or turns a little needs the same photons, and a
/// second camera of a cell adds nothing. Adds nothing, too, if the camera sees no surface.
///
/// The positions of a cell form a cube of edge 2^k m, the largest that is neither longer than the median distance of
/// visible surfaces nor than half the height of the picture at this distance; its directions lie within a third of the
/// angle of view. Up to eight cameras represent a cell: one at the centre of each octant of the cube, if the given
/// camera sees this centre. Their pictures are half as wide again. Each sends kPlacesOfEye rays through stratified
/// positions of its picture, which pass mirrors and glass (seen_through) and then make up to two cosine-distributed
/// bounces. Only the ratio of the picture's `width` and `height` matters.
void look_around(const Tracer& tracer, const PlacedCamera& camera, int width, int height, SeenAround& seen);

/// Divides world space into the cells of an octree and returns a sphere around each cell that holds places. The edge of
/// a cell is a power of two in m, and its corners are multiples of the edge, so small movements of the places do not
/// change the cells. Cells with more than 1/32 of the weight are divided in eight, the heaviest first. A cell is not
/// divided if there would be more than formats::kMaxViewSpheres cells, or cells smaller than about a quarter of the
/// median distance of visible places. Cells with less than 1/512 of the weight get no sphere; uniform photons light
/// them. The weight of a sphere is the weight of its cell over that of all places, rounded to a power of two.
///
/// Returns no sphere if aiming gains less than a factor of 2. The gain is the density of photons aimed at the spheres
/// (Aim) over the density of uniform photons on the disc of radius `scene_radius` [m], as the geometric mean over
/// places. Reasons: docs/methods/aim.md.
std::vector<formats::ViewSphere> spheres_around(const std::vector<WeighedPlace>& places, double scene_radius);

/// The spheres in scene space. `origin`: world-space position of the scene space's origin [m].
std::vector<AimSphere> spheres_in_scene(const std::vector<formats::ViewSphere>& view, Vec3d origin);

/// spheres_around() the places of look_around(), in scene space. scene_radius [m].
std::vector<AimSphere> spheres_seen(const Tracer& tracer, double scene_radius, const CameraView& view);

/// Lights that aim photons of sun and sky at spheres_seen() of a camera (docs/methods/aim.md). `which`: as for Lights.
Lights aimed_lights(const Tracer& tracer, EmissionTable table, const CameraView& view,
                    Lights::Which which = Lights::Which::all);

}  // namespace tempolux
