#include "lib/pilot/photon_shares.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numeric>
#include <optional>

#include "lib/core/grid.h"
#include "lib/core/halton.h"
#include "lib/core/parallel_each.h"
#include "lib/photon/photon_trace.h"
#include "lib/pilot/pilot_photons.h"
#include "lib/pilot/seen_spheres.h"

namespace tempolux {
namespace {

/// Least gain in the variance of the photons for which shares are used: below, the picture is kept as it was.
constexpr double kLeastGain = 1.25;
/// Paths of each light in the pilot, at least.
constexpr std::uint64_t kLeastPathsOfLight = 1024;
/// A pilot with fewer photons in all cells than this, or with some paths of sun and sky but too few to find openings,
/// is repeated with four times the paths, up to kMostTimes the paths.
constexpr std::size_t kFewestPhotons = 1000;
constexpr std::uint64_t kMostTimes = 16;

/// The lights of the pilot are nodes of the scene. Slots of the emission table that belong to one node share the
/// photons of the node by flux.
struct NodesOfSlots {
  std::vector<std::uint32_t> node;         ///< by slot: index in the file, or formats::ViewLight::kEnvironment
  std::map<std::uint32_t, double> shares;  ///< by node: sum of the probabilities of its slots, if above 0

  NodesOfSlots(const SceneFrame& frame, const EmissionTable& table) {
    const auto in_file = [&](std::uint32_t n) {
      return frame.scene && n < frame.scene->nodes.size() ? frame.scene->nodes[n].source_index : n;
    };
    for (std::size_t i = 0; i < table.surfaces.size(); ++i)
      node.insert(node.end(), table.parts[i]->all().size(), in_file(frame.surfaces[table.surfaces[i]].node));
    for (const PlacedLight& light : frame.lights) node.push_back(in_file(light.node));
    if (table.environment) node.push_back(formats::ViewLight::kEnvironment);
    for (std::size_t slot = 0; slot < node.size(); ++slot)
      if (table.probability[slot] > 0) shares[node[slot]] += table.probability[slot];
  }
};

/// An estimate of the direct light that each node brings to the cells: sum of share of the flux / (4 pi d^2), d at
/// least the cell's radius. Infinite for distant lights, which shine everywhere.
std::map<std::uint32_t, double> rough_importance(const SceneFrame& frame, const EmissionTable& table,
                                                 const NodesOfSlots& nodes, std::span<const AimSphere> cells) {
  std::map<std::uint32_t, double> importance;
  std::size_t slot = 0;
  const auto add = [&](Vec3d place) {
    double sum = 0;
    for (const AimSphere& cell : cells)
      sum += cell.weight / (4 * kPiD * std::max(length2(cell.centre - place), cell.radius * cell.radius));
    importance[nodes.node[slot]] += table.probability[slot] * sum;
    ++slot;
  };
  for (std::size_t i = 0; i < table.surfaces.size(); ++i) {
    const Surface& surface = frame.surfaces[table.surfaces[i]];
    for (const EmissionPart& part : table.parts[i]->all())
      add(Vec3d(surface.position(surface.primitive->triangles[part.triangle][0])));
  }
  for (const PlacedLight& placed : frame.lights) {
    if (placed.light.distant()) importance[nodes.node[slot++]] = INFINITY;
    else add(Vec3d(placed.position));
  }
  if (table.environment) importance[nodes.node[slot]] = INFINITY;
  return importance;
}

/// The nodes that the pilot measures: all, or the kMaxViewLights most important ones.
std::vector<std::uint32_t> measured_nodes(const SceneFrame& frame, const EmissionTable& table,
                                          const NodesOfSlots& nodes, std::span<const AimSphere> cells) {
  std::vector<std::uint32_t> measured;
  for (const auto& [node, share] : nodes.shares) measured.push_back(node);
  if (measured.size() <= formats::kMaxViewLights) return measured;
  const std::map<std::uint32_t, double> importance = rough_importance(frame, table, nodes, cells);
  std::ranges::stable_sort(measured, std::greater(), [&](std::uint32_t node) { return importance.at(node); });
  measured.resize(formats::kMaxViewLights);
  return measured;
}

/// The table with as many paths for each of these lights as for the others.
EmissionTable alike(EmissionTable table, const NodesOfSlots& nodes, std::span<const std::uint32_t> lights) {
  for (std::size_t slot = 0; slot < nodes.node.size(); ++slot) {
    const std::uint32_t node = nodes.node[slot];
    double& p = table.probability[slot];
    p = p > 0 && std::ranges::count(lights, node) ? p / (nodes.shares.at(node) * double(lights.size())) : 0;
  }
  return table;
}

/// True if one of kTests places, chosen by `number`, sees the photon: photons on the outside of a wall or in the next
/// room may be in the cell, too.
bool is_seen(const Tracer& tracer, std::span<const WeighedPlace> places, const formats::Photon& photon,
             std::uint64_t number) {
  constexpr std::uint32_t kTests = 4;
  constexpr double kLift = 1e-3;  // of the distance, above both surfaces: more than floats lose, less than what is seen
  const Vec3d at(vec_of(photon.position)), normal(vec_of(formats::decode_normal(photon.normal)));
  const PathRandom random(0, number);
  for (std::uint32_t test = 0; test < kTests; ++test) {
    const auto chosen = std::size_t(random.get1(test, Purpose::place) * float(places.size()));
    const WeighedPlace& place = places[std::min(chosen, places.size() - 1)];
    const Vec3d from = place.position - tracer.frame().origin;
    const double lift = kLift * length(at - from);
    if (sees(tracer, from + Vec3d(place.normal) * lift, at + normal * lift)) return true;
  }
  return false;
}

/// A photon of sun or sky in a cell.
struct DistantPhoton {
  std::uint64_t path;
  std::size_t cell;
  double flux;  ///< W
};

/// The flux that the paths of each light bring into the cells.
struct Arrivals {
  std::vector<double> flux, square;  ///< by cell and light: sums over photons of flux [W] and of its square
  std::size_t photons = 0;           ///< in all cells
  std::vector<DistantPhoton> distant;

  explicit Arrivals(std::size_t size) : flux(size), square(size) {}
  bool too_few() const {
    std::size_t starts = 0;  // paths of sun and sky; the photons of a path follow each other
    for (std::size_t i = 0; i < distant.size(); ++i) starts += i == 0 || distant[i].path != distant[i - 1].path;
    return photons < kFewestPhotons || (starts > 0 && starts < kFewestStarts);
  }
  void add(std::size_t at, double of_photon) {
    flux[at] += of_photon;
    square[at] += of_photon * of_photon;
    ++photons;
  }
  void add(const Arrivals& other) {
    photons += other.photons;
    distant.insert(distant.end(), other.distant.begin(), other.distant.end());
    for (std::size_t i = 0; i < flux.size(); ++i) flux[i] += other.flux[i], square[i] += other.square[i];
  }
};

/// Cells and the places that are seen in each.
struct SeenCells {
  std::vector<AimSphere> cells;
  std::span<const std::vector<WeighedPlace>> places;
};

/// Traces the paths and counts what arrives in the cells. `light_of_slot`: index of the light of each slot.
Arrivals arrivals(const PhotonTracer& photons, const Lights& lights, const Tracer& tracer,
                  std::span<const std::size_t> light_of_slot, const SeenCells& seen) {
  constexpr std::uint64_t kBatch = PhotonTracer::kBatch;
  const std::size_t count = std::ranges::max(light_of_slot) + 1, size = seen.cells.size() * count;
  const std::uint64_t paths = photons.photon_count();
  const PhotonHalton halton(photons.seed());
  std::vector<Arrivals> batches((paths + kBatch - 1) / kBatch, Arrivals(size));
  parallel_each(batches.size(), 1, [&](std::size_t b) {
    std::vector<std::uint64_t> numbers(std::min(kBatch, paths - b * kBatch));
    std::iota(numbers.begin(), numbers.end(), b * kBatch);
    const PhotonBatch batch = photons.trace_paths(numbers);
    for (std::size_t i = 0; i < batch.block.photons.size(); ++i) {
      const formats::Photon& photon = batch.block.photons[i];
      std::optional<std::uint32_t> slot;
      for (std::size_t k = 0; k < seen.cells.size(); ++k) {
        if (seen.places[k].empty() || !seen.cells[k].holds(Vec3d(vec_of(photon.position))) ||
            !is_seen(tracer, seen.places[k], photon, b * kBatch + i))
          continue;
        const std::uint64_t path = numbers[batch.path_of[i]];
        if (!slot) slot = lights.emit(halton.point(path)).slot;
        const double flux = emission_weight(Rgbd(Rgb(photon.flux[0], photon.flux[1], photon.flux[2])));
        batches[b].add(k * count + light_of_slot[*slot], flux);
        if (lights.is_distant(*slot)) batches[b].distant.push_back({path, k, flux});
      }
    }
  });
  Arrivals all(size);
  for (const Arrivals& batch : batches) all.add(batch);
  return all;
}

/// The starts of the paths of these photons.
std::vector<DistantStart> starts_of(std::span<const DistantPhoton> photons, std::span<const double> square_of_flux,
                                    const Lights& lights, const PhotonHalton& halton, Vec3d origin) {
  std::vector<DistantStart> starts;
  std::uint64_t last = 0;
  for (const DistantPhoton& photon : photons) {
    if (starts.empty() || photon.path != last) {
      const PhotonEmission e = lights.emit(halton.point(photon.path));
      const Vec3 inside = e.origin + e.travel * float(lights.aim().scene_radius());
      starts.push_back({Vec3d(inside) + origin, Vec3d(e.travel), 0, lights.aim().density(inside, e.travel)});
      last = photon.path;
    }
    if (square_of_flux[photon.cell] > 0)
      starts.back().value2 += photon.flux * photon.flux / square_of_flux[photon.cell];
  }
  return starts;
}

}  // namespace

SharePilot::SharePilot(std::vector<formats::ViewSphere> cells, std::span<const WeighedPlace> places, std::string kinds)
    : cells_(std::move(cells)), places_(cells_.size()), kinds_(std::move(kinds)) {
  double sum = 0;
  for (std::size_t k = 0; k < cells_.size(); ++k) {
    const AimSphere cell{vec_of(cells_[k].centre), cells_[k].radius};
    std::ranges::copy_if(places, std::back_inserter(places_[k]),
                         [&](const WeighedPlace& place) { return cell.holds(place.position); });
    sum += cells_[k].weight;
  }
  for (formats::ViewSphere& cell : cells_) cell.weight /= sum;
}

bool has_several_lights(const SceneFrame& frame, const EmissionTable& table) {
  return NodesOfSlots(frame, table).shares.size() > 1;
}

void SharePilot::look(const Tracer& tracer, const EmissionTable& table) {
  const SceneFrame& frame = tracer.frame();
  const SeenCells seen{spheres_in_scene(cells_, frame.origin), places_};
  const NodesOfSlots nodes(frame, table);
  const std::vector<std::uint32_t> lights = measured_nodes(frame, table, nodes, seen.cells);
  if (cells_.empty() || (lights.size() < 2 && !frame.scene->has_distant_light())) return;
  std::vector<std::size_t> light_of_slot;  // 0 for slots that emit nothing
  for (const std::uint32_t node : nodes.node) {
    const auto found = std::ranges::find(lights, node);
    light_of_slot.push_back(found == lights.end() ? 0 : std::size_t(found - lights.begin()));
  }
  const Lights emitters(frame, alike(table, nodes, lights));
  PhotonOptions options{.group_count = 1};
  options.set_kinds(kinds_);
  options.store_volume = false;
  options.photon_count = std::max(kPilotPaths, kLeastPathsOfLight * lights.size());
  Arrivals all(0);
  for (std::uint64_t times = 1; times <= kMostTimes && all.too_few(); times *= 4) {
    all = arrivals(PhotonTracer(tracer, emitters, options), emitters, tracer, light_of_slot, seen);
    options.photon_count *= 4;
  }
  before_ = nodes.shares;
  std::vector<double> square_of_flux(cells_.size());  // by cell: E_k^2 / c_k
  for (std::size_t k = 0; k < cells_.size(); ++k) {
    const auto row = std::span(all.flux).subspan(k * lights.size(), lights.size());
    const double flux = std::accumulate(row.begin(), row.end(), 0.0);
    if (!(flux > 0)) continue;
    square_of_flux[k] = flux * flux / cells_[k].weight;
    for (std::size_t i = 0; i < lights.size(); ++i)
      squares_[lights[i]] += cells_[k].weight * all.square[k * lights.size() + i] / (flux * flux);
  }
  const auto starts = starts_of(all.distant, square_of_flux, emitters, PhotonHalton(options.seed), frame.origin);
  starts_.insert(starts_.end(), starts.begin(), starts.end());
  table_ = table;
  origin_ = frame.origin;
}

std::vector<formats::ViewSphere> SharePilot::openings() const { return find_openings(starts_, table_, origin_); }

std::vector<formats::ViewLight> SharePilot::shares() const {
  double sum = 0;
  for (const auto& [node, square] : squares_) sum += std::sqrt(square);
  std::vector<formats::ViewLight> shares;
  // A share is rounded to a power of two, so that a small change of the scene keeps it. Lights that get less than a
  // pilot path's part of the photons are left out.
  for (const auto& [node, square] : squares_)
    if (const double share = std::sqrt(square) / sum; share > 1.0 / double(kPilotPaths))
      shares.push_back({node, nearest_on_grid(share, 1)});
  double given = 0, variance = 0, variance_before = 0;
  for (const formats::ViewLight& light : shares) given += light.share;
  for (const formats::ViewLight& light : shares) {
    const double before = before_.contains(light.node) ? before_.at(light.node) : 0;
    if (!(before > 0)) continue;
    variance += squares_.at(light.node) / (kUnguidedShare * before + (1 - kUnguidedShare) * light.share / given);
    variance_before += squares_.at(light.node) / before;
  }
  return variance_before >= kLeastGain * variance && variance > 0 ? shares : std::vector<formats::ViewLight>();
}

void give_shares(const SceneFrame& frame, std::span<const formats::ViewLight> shares, EmissionTable& table) {
  if (shares.empty()) return;
  const NodesOfSlots nodes(frame, table);
  std::map<std::uint32_t, double> wanted;
  double sum = 0;
  for (const formats::ViewLight& light : shares)
    if (nodes.shares.contains(light.node)) wanted[light.node] += light.share, sum += light.share;
  if (!(sum > 0)) return;
  for (std::size_t slot = 0; slot < nodes.node.size(); ++slot) {
    double& p = table.probability[slot];
    if (!(p > 0)) continue;
    const auto found = wanted.find(nodes.node[slot]);
    const double guided = found == wanted.end() ? 0 : found->second / sum * p / nodes.shares.at(nodes.node[slot]);
    p = double(kUnguidedShare) * p + (1 - double(kUnguidedShare)) * guided;
  }
}

}  // namespace tempolux
