// lib/render/seen_spheres.h -- a few spheres on a lattice that hold the places at which cameras look.
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
  Vec3d position{};  ///< world space, m
  /// 1 for a place that the camera sees, halved at each bounce because surfaces reflect about half
  double weight = 0;
  double distance = 0;  ///< m, from the camera; 0 for a place that was not seen directly
};

/// The places that cameras and their neighbours in the lattice see.
struct SeenAround {
  std::vector<WeighedPlace> places;
  std::set<std::array<double, 9>> looked;  ///< cells of the lattice of cameras that have been used
};

/// Adds the places that a camera and those around it see in the scene of `tracer`. All cameras in one cell of a lattice
/// get the same places, so that a camera which moves or turns a little needs the same photons. A second camera in one
/// cell adds nothing.
///
/// A cell is a cube of edge 2^k m, the largest that is neither longer than the median distance d of visible surfaces
/// nor than half the height h of the picture at that distance; directions have steps of a third of the angle of view.
/// The cell has up to eight cameras: one at the centre of each octant of the cube, if the given camera sees this
/// centre. Their pictures are half as wide again. Each camera sends rays through 256 stratified positions of its
/// picture, which pass mirrors and glass (seen_through) and then make up to two cosine-distributed bounces. Only the
/// ratio of `width` and `height` of the picture counts.
void look_around(const Tracer& tracer, const PlacedCamera& camera, int width, int height, SeenAround& seen);

/// Divides space into the cells of an octree and computes a sphere around each cell that holds places. A cell's size is
/// a power of two, and its corners are multiples of the size, so small movements of the places do not change the cells.
/// Cells with more than 1/32 of the weight are divided in eight, the heaviest first. A cell stays whole if there would
/// be more than formats::kMaxViewSpheres cells, or cells smaller than about a quarter of the median distance of visible
/// places. Cells with less than 1/512 of the weight get no sphere; uniform photons light them. The weight of a sphere
/// is its cell's share, rounded to a power of two.
///
/// Returns no sphere if aiming gains little. The gain is how much denser photons aimed at the spheres (Aim) are than
/// uniform photons on the disc of radius `scene_radius` [m], as the geometric mean over places. Spheres need a gain of
/// at least 2. Reasons: docs/methods/aim.md.
std::vector<formats::ViewSphere> spheres_around(const std::vector<WeighedPlace>& places, double scene_radius);

/// The spheres in scene space; `origin`: the frame's.
std::vector<AimSphere> spheres_in_scene(const std::vector<formats::ViewSphere>& view, Vec3d origin);

/// The spheres, in scene space, around the places that this camera and those around it see. scene_radius [m].
std::vector<AimSphere> spheres_seen(const Tracer& tracer, double scene_radius, const CameraView& view);

/// Lights that aim photons of sun and sky at the places that the camera sees (docs/methods/aim.md). `which`: as for
/// Lights.
Lights aimed_lights(const Tracer& tracer, EmissionTable table, const CameraView& view,
                    Lights::Which which = Lights::Which::all);

}  // namespace tempolux
