// lib/pilot/seen_spheres.h -- spheres on a lattice around the places that cameras see, at which photons are aimed.
#pragma once

#include <array>
#include <set>
#include <string>
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
  Vec3 normal{};        ///< of the triangle, unit, on the side that is seen
};

/// Places that look_around() has found.
struct SeenAround {
  std::vector<WeighedPlace> places;
  std::set<std::array<double, 11>> looked;  ///< cells of the lattice of cameras whose places were added
};

/// Adds places that stand-in cameras see in place of the given camera. A lattice divides the positions and directions
/// of all cameras into cells. All cameras of one cell that see the same octants (below) have the same stand-ins. So a
/// camera that moves or turns a little needs the same photons, and a second such camera adds nothing. A camera that
/// sees no surface adds nothing either.
///
/// The positions of a cell form a cube. Its edge is 2^k m: the largest such edge that exceeds neither the median
/// distance of visible surfaces nor half the height of the picture at this distance. The directions of a cell span a
/// third of the angle of view. The stand-ins are at the centres of the cube's octants, as far as the given camera sees
/// these centres; if it sees none, the given camera represents itself. The picture of a stand-in is 1.5 times as wide
/// and high. Each stand-in sends kPlacesOfEye rays through stratified positions of its picture. The rays pass mirrors
/// and glass (seen_through) and then make up to two cosine-distributed bounces. `width` and `height` give only the
/// aspect ratio of the picture.
void look_around(const Tracer& tracer, const PlacedCamera& camera, int width, int height, SeenAround& seen);

/// Spheres around cells of space that hold what cameras see.
struct SeenSpheres {
  std::vector<formats::ViewSphere> spheres;  ///< sorted by place
  /// True if aim makes photons at least twice as dense. At each place the density of photons aimed at the place's
  /// sphere (Aim) is compared with that of photons that are uniform on the scene's disc. The geometric mean of the
  /// ratio over all places decides. Reasons: docs/methods/aim.md.
  bool worth_aiming = false;
};

/// Divides world space into the cells of an octree and returns a sphere around each cell that holds places. The edge of
/// a cell is a power of two in m, and its corners are multiples of the edge, so small movements of the places do not
/// change the cells. Cells with more than 1/32 of the weight are divided in eight, the heaviest first. A cell is not
/// divided if there would be more than formats::kMaxViewSpheres cells, or cells smaller than about a quarter of the
/// median distance of visible places. Cells with less than 1/512 of the weight get no sphere; uniform photons light
/// them. The weight of a sphere is the weight of its cell over that of all places, rounded to a power of two.
/// `scene_radius` [m]: radius of the scene's disc.
SeenSpheres seen_spheres(const std::vector<WeighedPlace>& places, double scene_radius);

/// The spheres of seen_spheres() if they are worth aiming at, else none.
std::vector<formats::ViewSphere> spheres_around(const std::vector<WeighedPlace>& places, double scene_radius);

/// True if no surface lies between two places in scene space.
bool sees(const Tracer& tracer, Vec3d from, Vec3d to);

/// The spheres in scene space. `origin`: world-space position of the scene space's origin [m].
std::vector<AimSphere> spheres_in_scene(const std::vector<formats::ViewSphere>& view, Vec3d origin);

/// Aims the photons of `table` where the camera looks (docs/methods/aim.md): its spheres, and the share of each light
/// (photon_shares.h). `kinds`: the kinds of photons that are wanted, as for PhotonOptions::set_kinds.
void aim_at_seen(const Tracer& tracer, const CameraView& view, const std::string& kinds, EmissionTable& table);

/// Lights whose photons are aimed at the spheres; their shares follow from flux, since the pilot of shares would cost
/// as much as the audit of a frame. `which`: as for Lights.
Lights aimed_lights(const Tracer& tracer, EmissionTable table, const CameraView& view,
                    Lights::Which which = Lights::Which::all);

}  // namespace tempolux
