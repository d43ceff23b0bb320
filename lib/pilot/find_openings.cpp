#include "lib/pilot/find_openings.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "lib/core/arrays.h"
#include "lib/core/grid.h"
#include "lib/pilot/lattice_cell.h"
#include "lib/pilot/seen_spheres.h"

namespace tempolux {
namespace {

constexpr double kLeastOpeningGain = 1.25;  ///< in the variance; as kLeastGain of the shares of lights
constexpr std::size_t kMostStarts = 1024;   ///< that choose, and that measure: bounds the time of the search
constexpr int kLevels = 6;                  ///< of lattices: the smallest cells have 1/64 of the scene's radius

bool passes(const DistantStart& start, Vec3d centre, double radius) {
  return length2(cross(centre - start.origin, start.travel)) < radius * radius;
}

double weight2(const DistantStart& start) { return start.value2 * start.density; }

/// Every n-th start, so that at most kMostStarts are left; those with even or with odd places.
std::vector<DistantStart> some_of(std::span<const DistantStart> starts, std::size_t first) {
  std::vector<DistantStart> some;
  const std::size_t step = 2 * ((starts.size() + 2 * kMostStarts - 1) / (2 * kMostStarts));
  for (std::size_t i = first; i < starts.size(); i += step) some.push_back(starts[i]);
  return some;
}

using StartsOfCells = std::map<LatticeCell, std::vector<std::size_t>>;

/// Finds the cells that the lines of the starts pass inside the scene's sphere, and lists the starts of each cell.
/// `centre` is the centre of this sphere in world space, `radius` its radius, both in m.
StartsOfCells cells_passed(std::span<const DistantStart> starts, Vec3d centre, double radius) {
  StartsOfCells cells;
  const int top = std::ilogb(radius) - 1;
  for (int level = top; level > top - kLevels; --level) {
    const double step = std::ldexp(0.5, level);
    for (std::size_t i = 0; i < starts.size(); ++i) {
      LatticeCell last{top + 1};
      const double middle = dot(centre - starts[i].origin, starts[i].travel);
      for (double along = middle - radius; along <= middle + radius; along += step) {
        const LatticeCell cell = LatticeCell::at(starts[i].origin + starts[i].travel * along, level);
        if (cell == last) continue;
        last = cell;
        std::vector<std::size_t>& passing = cells[cell];
        if (passing.empty() || passing.back() != i) passing.push_back(i);
      }
    }
  }
  return cells;
}

/// The chosen spheres with their weights, around cells that hold more than `fewest` starts.
std::vector<formats::ViewSphere> choose(std::span<const DistantStart> starts, const StartsOfCells& cells,
                                        std::size_t fewest) {
  std::vector<bool> held(starts.size());
  std::vector<formats::ViewSphere> spheres;
  double whole = 0;
  while (spheres.size() < formats::kMaxViewSpheres) {
    double best = 0;
    const LatticeCell* chosen = nullptr;
    for (const auto& [cell, passing] : cells) {
      std::size_t left = 0;
      double sum = 0;
      for (const std::size_t i : passing)
        if (!held[i]) ++left, sum += weight2(starts[i]);
      const double square = cell.edge() * cell.edge();
      if (left > fewest && sum > best * square) best = sum / square, chosen = &cell;
    }
    if (!chosen) break;
    formats::ViewSphere sphere = chosen->sphere();
    double sum = 0;
    for (std::size_t i = 0; i < starts.size(); ++i)
      if (!held[i] && passes(starts[i], vec_of(sphere.centre), sphere.radius))
        held[i] = true, sum += weight2(starts[i]);
    sphere.weight = sphere.radius * std::sqrt(sum);
    whole += sphere.weight;
    spheres.push_back(sphere);
  }
  for (formats::ViewSphere& sphere : spheres) sphere.weight = nearest_on_grid(sphere.weight / whole, 1);
  sort_by_place(spheres);
  return spheres;
}

/// V of find_openings().
double variance_with(const Aim& aim, std::span<const DistantStart> starts, Vec3d origin) {
  double before = 0, after = 0;
  for (const DistantStart& start : starts) {
    before += start.value2;
    after += start.value2 * start.density / aim.density(Vec3(start.origin - origin), Vec3(start.travel));
  }
  return after / before;
}

}  // namespace

std::vector<formats::ViewSphere> find_openings(std::span<const DistantStart> starts, const EmissionTable& table,
                                               Vec3d origin) {
  const std::vector<DistantStart> choosing = some_of(starts, 0), measuring = some_of(starts, 1);
  if (choosing.size() < kFewestStarts / 2 || !(table.sphere_radius > 0)) return {};
  const StartsOfCells cells = cells_passed(choosing, table.sphere_centre + origin, table.sphere_radius);
  std::vector<formats::ViewSphere> openings;
  double least = 1 / kLeastOpeningGain;
  for (std::size_t cells_wanted = formats::kMaxViewSpheres; cells_wanted > 0; cells_wanted /= 2) {
    std::vector<formats::ViewSphere> chosen = choose(choosing, cells, choosing.size() / (cells_wanted + 1));
    if (chosen.empty()) continue;
    const Aim aim(table.aim, spheres_in_scene(chosen, origin), Vec3(table.sphere_centre), table.sphere_radius);
    if (const double v = variance_with(aim, measuring, origin); v < least) least = v, openings = std::move(chosen);
  }
  return openings;
}

}  // namespace tempolux
