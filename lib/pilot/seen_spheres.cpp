#include "lib/pilot/seen_spheres.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include "lib/core/arrays.h"
#include "lib/core/frame.h"
#include "lib/core/grid.h"
#include "lib/core/sampling.h"
#include "lib/core/sobol.h"
#include "lib/light/aim.h"
#include "lib/render/known_light.h"
#include "lib/pilot/lattice_cell.h"
#include "lib/pilot/photon_shares.h"
#include "lib/pilot/places_seen.h"

namespace tempolux {
namespace {

constexpr double kReflected = 0.5;  ///< weight of a place over that of the place before it: surfaces reflect about half
constexpr int kBounces = 2;         ///< all further bounces together would have the weight of the second
constexpr double kSplitShare = 1.0 / double(formats::kMaxViewSpheres);  ///< cells above this share are divided
/// Share of the weight below which a cell has less than one place per camera: the places of a camera ray weigh at
/// most 2.
constexpr double kLeastShare = 1.0 / (2 * kPlacesOfEye);
constexpr double kLeastGain = 1;  ///< log2 of the least gain in density: twice as dense

/// A cell of the octree.
struct Cell {
  LatticeCell cube;
  std::vector<const WeighedPlace*> places;
  double weight = 0;
};

/// The cells of this level that hold the places, ordered by index.
std::vector<Cell> cells_of(const std::vector<const WeighedPlace*>& places, int level) {
  std::map<LatticeCell, Cell> cells;
  for (const WeighedPlace* place : places) {
    const LatticeCell cube = LatticeCell::at(place->position, level);
    Cell& cell = cells[cube];
    cell.cube = cube;
    cell.places.push_back(place);
    cell.weight += place->weight;
  }
  std::vector<Cell> list;
  for (auto& [cube, cell] : cells) list.push_back(std::move(cell));
  return list;
}

/// Exponent of the smallest power of two that is not below x.
int level_above(double x) {
  int exponent;
  return std::frexp(x, &exponent) == 0.5 ? exponent - 1 : exponent;
}

/// Median distance [m] of the places that were seen directly; 0 if there are none.
double median_distance(std::vector<WeighedPlace> places) {
  std::erase_if(places, [](const WeighedPlace& place) { return !(place.distance > 0); });
  if (places.empty()) return 0;
  const auto middle = places.begin() + std::ptrdiff_t(places.size() / 2);
  std::ranges::nth_element(places, middle, {}, &WeighedPlace::distance);
  return middle->distance;
}

/// Level of the smallest cells: their edge is a quarter of the median distance, rounded down to a power of two. No
/// limit if nothing was seen directly.
int lowest_level(const std::vector<WeighedPlace>& places) {
  const double distance = median_distance(places);
  return distance > 0 ? std::ilogb(distance / 4) : -1000;
}

/// Divides heavy cells while the limit of their number allows, and drops light cells. whole: weight of all places;
/// lowest: level of the smallest cells.
std::vector<Cell> split(std::vector<Cell> cells, double whole, int lowest) {
  const auto drop_light = [&](std::vector<Cell>& some) {
    std::erase_if(some, [&](const Cell& cell) { return cell.weight < kLeastShare * whole; });
  };
  std::vector<Cell> done;
  drop_light(cells);
  while (!cells.empty()) {
    const auto heaviest = std::ranges::max_element(cells, {}, &Cell::weight);
    Cell cell = std::move(*heaviest);
    cells.erase(heaviest);
    std::vector<Cell> parts;
    if (cell.weight > kSplitShare * whole && cell.cube.level > lowest) {
      parts = cells_of(cell.places, cell.cube.level - 1);
      drop_light(parts);
    }
    if (parts.empty() || done.size() + cells.size() + parts.size() > formats::kMaxViewSpheres)
      done.push_back(std::move(cell));
    else std::ranges::move(parts, std::back_inserter(cells));
  }
  return done;
}

/// Adds the places that a camera sees and those of kBounces bounces from there. `number`: key of the random numbers.
void add_seen_places(const Tracer& tracer, const CameraView& view, std::uint64_t number,
                     std::vector<WeighedPlace>& places) {
  const Vec3d origin = tracer.frame().origin;
  const auto add = [&](Vec3 position, Vec3 normal, double weight, double distance) {
    places.push_back({Vec3d(position) + origin, weight, distance, normal});
  };
  for (std::uint32_t i = 0; i < kPlacesOfEye; ++i) {
    const PathRandom random(number, i);
    const Vec2 where = sobol_owen_2d(i, number);
    const Look look{where.x * float(view.width()), where.y * float(view.height()), random};
    const std::optional<SeenPoint> seen = seen_through(tracer, view, look);
    if (!seen) continue;
    SurfacePoint at = seen->surface;
    Vec3 normal = at.normal_geometric * std::copysign(1.0f, dot(at.normal_geometric, seen->normal));
    add(at.position, normal, 1, length(Vec3d(at.position) - Vec3d(view.eye())));
    double weight = kReflected;
    for (std::uint32_t bounce = 1; bounce <= kBounces; ++bounce, weight *= kReflected) {
      const Ray ray = spawn_ray(at, Frame(normal).to_world(sample_hemisphere_cos(random.get2(bounce, Purpose::place))));
      Hit hit;
      if (!tracer.intersect(ray, hit)) break;
      at = tracer.surface_point(hit);
      normal = at.normal_geometric * -std::copysign(1.0f, dot(at.normal_geometric, ray.direction));
      add(at.position, normal, weight, 0);
    }
  }
}

// ---- a lattice of cameras -----------------------------------------------------------------------------------

/// Height of a representative's picture over that of the camera: a quarter more on each side. The camera's direction
/// differs from the lattice direction by at most half a step, a sixth of the angle of view.
constexpr double kWider = 1.5;
/// Offset of the lattice's planes in steps, so that coordinates which people type (0, 0.5, 1.6) are not close to a
/// plane.
constexpr double kShift = 1.0 / 3;

/// Yaw about +y, pitch and roll [radians] of the rotation `a` from camera space; with all angles 0 the camera looks
/// along -z.
std::array<double, 3> angles_of(const Affine& a) {
  const Vec3d right = a.direction({1, 0, 0}), forward = a.direction({0, 0, -1});
  const double yaw = std::atan2(-forward.x, -forward.z), pitch = std::asin(std::clamp(forward.y, -1.0, 1.0));
  const Vec3d level{std::cos(yaw), 0, -std::sin(yaw)};
  return {yaw, pitch, std::atan2(dot(right, cross(level, forward)), dot(right, level))};
}

/// The rotation of these yaw, pitch and roll.
Affine turned(const std::array<double, 3>& angles) {
  const auto [yaw, pitch, roll] = angles;
  const Vec3d forward{-std::sin(yaw) * std::cos(pitch), std::sin(pitch), -std::cos(yaw) * std::cos(pitch)},
      level{std::cos(yaw), 0, -std::sin(yaw)};
  const Vec3d right = std::cos(roll) * level + std::sin(roll) * cross(level, forward), up = cross(right, forward);
  Affine a;
  a.row = {Vec3d{right.x, up.x, -forward.x}, Vec3d{right.y, up.y, -forward.y}, Vec3d{right.z, up.z, -forward.z}};
  return a;
}

/// A cell of the lattice of cameras.
struct CameraCell {
  /// Level; indices of position and of direction; height of the picture; bits of the octants that have a camera; lens
  /// shift.
  std::array<double, 11> key{};
  std::vector<PlacedCamera> cameras;
};

/// The cell of a camera whose visible surfaces have this median distance [m].
CameraCell cell_of(const Tracer& tracer, const PlacedCamera& camera, double distance) {
  const bool perspective = camera.camera.kind == Camera::Kind::perspective;
  const double half_height = perspective ? distance * std::tan(camera.camera.yfov_rad / 2) : camera.camera.ymag_m;
  CameraCell cell;
  // The picture's half height, rounded to a quarter power of two.
  const int narrow = int(std::round(4 * std::log2(perspective ? half_height / distance : half_height)));
  const int level = int(std::floor(std::log2(std::min(distance, half_height))));
  const double size = std::ldexp(1.0, level), height = kWider * std::exp2(narrow / 4.0),
               step = 2.0 / 3 * std::atan(half_height / distance);
  PlacedCamera around = camera;
  (perspective ? around.camera.yfov_rad : around.camera.ymag_m) = perspective ? 2 * std::atan(height) : height;
  const double own = perspective ? half_height / distance : half_height;
  // Steps of the lens shift, in heights of the camera's picture: half of one and half a step of the direction are less
  // than what kWider adds on a side.
  const double shift_step = (kWider - 1) / 4;
  for (std::size_t i = 0; i < 2; ++i) {
    cell.key[9 + i] = std::round(camera.camera.lens_shift[i] / shift_step);
    around.camera.lens_shift[i] = cell.key[9 + i] * shift_step * own / height;
  }
  std::array<double, 3> angles = angles_of(camera.scene_from_camera);
  cell.key[0] = level;
  cell.key[7] = narrow;
  for (std::size_t i = 0; i < 3; ++i) {
    cell.key[4 + i] = std::round(angles[i] / step);
    angles[i] = cell.key[4 + i] * step;
  }
  around.scene_from_camera = turned(angles);
  const Vec3d eye = camera.scene_from_camera.translation, world = eye + tracer.frame().origin;
  const std::array places{world.x, world.y, world.z};
  std::array<double, 3> corner{};
  for (std::size_t i = 0; i < 3; ++i) {
    const double index = std::floor(places[i] / size + kShift);
    cell.key[1 + i] = index;
    corner[i] = (index - kShift) * size;
  }
  int eyes = 0;
  for (int part = 0; part < 8; ++part) {
    const auto at = [&](std::size_t axis) { return corner[axis] + size * (part >> axis & 1 ? 0.75 : 0.25); };
    around.scene_from_camera.translation = Vec3d{at(0), at(1), at(2)} - tracer.frame().origin;
    if (!sees(tracer, eye, around.scene_from_camera.translation)) continue;
    eyes |= 1 << part;
    cell.cameras.push_back(around);
  }
  cell.key[8] = eyes;
  if (eyes == 0) cell.cameras.push_back(camera);
  return cell;
}

}  // namespace

void look_around(const Tracer& tracer, const PlacedCamera& camera, int width, int height, SeenAround& seen) {
  const Vec3d origin = tracer.frame().origin;
  std::vector<WeighedPlace> own;
  add_seen_places(tracer, CameraView(camera, origin, width, height), 0, own);
  const double distance = median_distance(own);
  if (!(distance > 0)) return;
  const CameraCell cell = cell_of(tracer, camera, distance);
  if (!seen.looked.insert(cell.key).second) return;
  for (std::size_t i = 0; i < cell.cameras.size(); ++i)
    add_seen_places(tracer, CameraView(cell.cameras[i], origin, width, height), i, seen.places);
}

bool sees(const Tracer& tracer, Vec3d from, Vec3d to) {
  const Vec3d way = to - from;
  const double distance = length(way);
  return distance == 0 || !tracer.occluded({Vec3(from), Vec3(way / distance), 0, float(distance)});
}

SeenSpheres seen_spheres(const std::vector<WeighedPlace>& places, double scene_radius) {
  double farthest = 0, whole = 0;
  std::vector<const WeighedPlace*> all;
  for (const WeighedPlace& place : places) {
    const Vec3d& p = place.position;
    farthest = std::max({farthest, std::abs(p.x), std::abs(p.y), std::abs(p.z)});
    whole += place.weight;
    all.push_back(&place);
  }
  if (!(whole > 0) || !(farthest > 0) || !(scene_radius > 0)) return {};
  // Eight cells that meet at the world's origin hold all places.
  const std::vector<Cell> cells = split(cells_of(all, level_above(farthest) + 1), whole, lowest_level(places));

  std::vector<formats::ViewSphere> spheres;
  double weights = 0;
  for (const Cell& cell : cells) {
    formats::ViewSphere sphere = cell.cube.sphere();
    sphere.weight = nearest_on_grid(cell.weight / whole, 1);
    weights += sphere.weight;
    spheres.push_back(sphere);
  }
  double gain = 0, held = 0;
  for (std::size_t i = 0; i < cells.size(); ++i) {
    const double ratio = scene_radius / spheres[i].radius, share = (1 - Aim::kUniform) * spheres[i].weight / weights;
    gain += cells[i].weight / whole * std::log2(Aim::kUniform + share * ratio * ratio);
    held += cells[i].weight / whole;
  }
  gain += (1 - held) * std::log2(Aim::kUniform);
  sort_by_place(spheres);
  return {std::move(spheres), gain >= kLeastGain};
}

std::vector<formats::ViewSphere> spheres_around(const std::vector<WeighedPlace>& places, double scene_radius) {
  SeenSpheres seen = seen_spheres(places, scene_radius);
  return seen.worth_aiming ? std::move(seen.spheres) : std::vector<formats::ViewSphere>();
}

std::vector<AimSphere> spheres_in_scene(const std::vector<formats::ViewSphere>& view, Vec3d origin) {
  std::vector<AimSphere> spheres;
  for (const formats::ViewSphere& sphere : view)
    spheres.push_back({vec_of(sphere.centre) - origin, sphere.radius, sphere.weight});
  return spheres;
}

void aim_at_seen(const Tracer& tracer, const CameraView& view, const std::string& kinds, EmissionTable& table) {
  SeenAround around;
  look_around(tracer, view.camera(), view.width(), view.height(), around);
  const SeenSpheres seen = seen_spheres(around.places, table.sphere_radius);
  if (seen.worth_aiming) table.aim = spheres_in_scene(seen.spheres, tracer.frame().origin);
  SharePilot pilot(seen.spheres, around.places, kinds);
  pilot.look(tracer, table);
  give_shares(tracer.frame(), pilot.shares(), table);
  table.openings = spheres_in_scene(pilot.openings(), tracer.frame().origin);
}

Lights aimed_lights(const Tracer& tracer, EmissionTable table, const CameraView& view, Lights::Which which) {
  if (which != Lights::Which::placed) {
    SeenAround around;
    look_around(tracer, view.camera(), view.width(), view.height(), around);
    table.aim = spheres_in_scene(spheres_around(around.places, table.sphere_radius), tracer.frame().origin);
  }
  return Lights(tracer.frame(), table, which);
}

}  // namespace tempolux
