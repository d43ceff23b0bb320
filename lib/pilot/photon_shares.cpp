#include "lib/pilot/photon_shares.h"

#include <algorithm>
#include <cmath>
#include <numeric>

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
/// A pilot with fewer photons in all cells than this is repeated with four times the paths, up to kMostTimes the paths.
constexpr std::size_t kFewestPhotons = 1000;
constexpr std::uint64_t kMostTimes = 16;

/// The file's index of the node of each slot of the table; formats::ViewLight::kEnvironment for the environment.
std::vector<std::uint32_t> nodes_of_slots(const SceneFrame& frame, const EmissionTable& table) {
  const auto in_file = [&](std::uint32_t node) {
    return frame.scene && node < frame.scene->nodes.size() ? frame.scene->nodes[node].source_index : node;
  };
  std::vector<std::uint32_t> nodes;
  for (std::size_t i = 0; i < table.surfaces.size(); ++i)
    nodes.insert(nodes.end(), table.parts[i]->all().size(), in_file(frame.surfaces[table.surfaces[i]].node));
  for (const PlacedLight& light : frame.lights) nodes.push_back(in_file(light.node));
  if (table.environment) nodes.push_back(formats::ViewLight::kEnvironment);
  return nodes;
}

std::map<std::uint32_t, double> share_of_nodes(const EmissionTable& table, std::span<const std::uint32_t> nodes) {
  std::map<std::uint32_t, double> shares;
  for (std::size_t slot = 0; slot < nodes.size(); ++slot)
    if (table.probability[slot] > 0) shares[nodes[slot]] += table.probability[slot];
  return shares;
}

/// An estimate of the direct light that a slot brings to the cells, by which the lights are chosen that the pilot
/// measures: share of the flux / (4 pi d^2), d at least the cell's radius. Distant lights shine everywhere.
double rough_importance(const SceneFrame& frame, const EmissionTable& table, std::size_t slot,
                        std::span<const AimSphere> cells) {
  std::size_t triangles = 0;
  Vec3d place;
  for (std::size_t i = 0; i < table.surfaces.size(); ++i) {
    const auto& parts = table.parts[i]->all();
    if (slot - triangles < parts.size()) {
      const Surface& surface = frame.surfaces[table.surfaces[i]];
      place = Vec3d(surface.position(surface.primitive->triangles[parts[slot - triangles].triangle][0]));
      triangles = slot + 1;
      break;
    }
    triangles += parts.size();
  }
  if (triangles <= slot) {
    if (slot - triangles >= frame.lights.size() ||
        frame.lights[slot - triangles].light.kind == PunctualLight::Kind::directional)
      return INFINITY;
    place = Vec3d(frame.lights[slot - triangles].position);
  }
  double sum = 0;
  for (const AimSphere& cell : cells) {
    const Vec3d to = cell.centre - place;
    sum += cell.weight / (4 * kPiD * std::max(dot(to, to), cell.radius * cell.radius));
  }
  return table.probability[slot] * sum;
}

/// The nodes that the pilot measures: all, or the kMaxViewLights most important ones.
std::vector<std::uint32_t> measured_nodes(const SceneFrame& frame, const EmissionTable& table,
                                          std::span<const std::uint32_t> nodes, std::span<const AimSphere> cells) {
  std::vector<std::uint32_t> measured;
  for (const auto& [node, share] : share_of_nodes(table, nodes)) measured.push_back(node);
  if (measured.size() <= formats::kMaxViewLights) return measured;
  std::map<std::uint32_t, double> importance;
  for (std::size_t slot = 0; slot < nodes.size(); ++slot)
    if (table.probability[slot] > 0) importance[nodes[slot]] += rough_importance(frame, table, slot, cells);
  std::ranges::stable_sort(measured, std::greater(), [&](std::uint32_t node) { return importance.at(node); });
  measured.resize(formats::kMaxViewLights);
  return measured;
}

bool holds(const AimSphere& cell, Vec3d point) {
  const Vec3d to = point - cell.centre;
  return dot(to, to) < cell.radius * cell.radius;
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

/// What the paths of the lights bring into the cells.
struct Arrivals {
  std::vector<double> flux, square;  ///< by cell and light: sums over photons of flux [W] and of its square
  std::size_t photons = 0;           ///< in all cells

  explicit Arrivals(std::size_t size) : flux(size), square(size) {}
};

}  // namespace

SharePilot::SharePilot(std::vector<formats::ViewSphere> cells, std::span<const WeighedPlace> places, std::string kinds)
    : cells_(std::move(cells)), places_(cells_.size()), kinds_(std::move(kinds)) {
  for (std::size_t k = 0; k < cells_.size(); ++k)
    for (const WeighedPlace& place : places)
      if (holds({vec_of(cells_[k].centre), cells_[k].radius}, place.position)) places_[k].push_back(place);
  double sum = 0;
  for (const formats::ViewSphere& cell : cells_) sum += cell.weight;
  for (formats::ViewSphere& cell : cells_) cell.weight /= sum;
}

void SharePilot::look(const Tracer& tracer, const EmissionTable& table) {
  const SceneFrame& frame = tracer.frame();
  const std::vector<AimSphere> cells = spheres_in_scene(cells_, frame.origin);
  const std::vector<std::uint32_t> nodes = nodes_of_slots(frame, table);
  const std::map<std::uint32_t, double> before = share_of_nodes(table, nodes);
  const std::vector<std::uint32_t> lights = measured_nodes(frame, table, nodes, cells);
  if (lights.size() < 2 || cells.empty()) return;
  std::map<std::uint32_t, std::size_t> index;
  for (std::size_t i = 0; i < lights.size(); ++i) index[lights[i]] = i;

  EmissionTable equal = table;  // every light gets as many paths
  for (std::size_t slot = 0; slot < nodes.size(); ++slot) {
    const bool measured = table.probability[slot] > 0 && index.contains(nodes[slot]);
    equal.probability[slot] =
        measured ? table.probability[slot] / (before.at(nodes[slot]) * double(lights.size())) : 0;
  }
  const Lights emitters(frame, equal);
  Arrivals all(0);
  std::uint64_t paths = std::max(kPilotPaths, kLeastPathsOfLight * lights.size());
  for (std::uint64_t times = 1; times <= kMostTimes && all.photons < kFewestPhotons; times *= 4, paths *= 4) {
    PhotonOptions options{.seed = 0, .photon_count = paths, .group_count = 1};
    options.set_kinds(kinds_);
    options.store_volume = false;
    const PhotonTracer photons(tracer, emitters, options);
    const PhotonHalton halton(options.seed);
    constexpr std::uint64_t kBatch = PhotonTracer::kBatch;
    std::vector<Arrivals> batches((paths + kBatch - 1) / kBatch, Arrivals(cells.size() * lights.size()));
    parallel_each(batches.size(), 1, [&](std::size_t b) {
      std::vector<std::uint64_t> numbers(std::min(kBatch, paths - b * kBatch));
      std::iota(numbers.begin(), numbers.end(), b * kBatch);
      const PhotonBatch batch = photons.trace_paths(numbers);
      for (std::size_t i = 0; i < batch.block.photons.size(); ++i) {
        const formats::Photon& photon = batch.block.photons[i];
        const Rgbd flux(Rgb(photon.flux[0], photon.flux[1], photon.flux[2]));
        const double weight = std::max(luminance(flux), 0.05 * max_component(flux));
        std::size_t light = lights.size();
        for (std::size_t k = 0; k < cells.size(); ++k) {
          if (places_[k].empty() || !holds(cells[k], Vec3d(vec_of(photon.position))) ||
              !is_seen(tracer, places_[k], photon, b * kBatch + i))
            continue;
          if (light == lights.size())
            light = index.at(nodes[emitters.emit(halton.point(numbers[batch.path_of[i]])).slot]);
          batches[b].flux[k * lights.size() + light] += weight;
          batches[b].square[k * lights.size() + light] += weight * weight;
          ++batches[b].photons;
        }
      }
    });
    all = Arrivals(cells.size() * lights.size());
    for (const Arrivals& batch : batches) {
      all.photons += batch.photons;
      for (std::size_t i = 0; i < all.flux.size(); ++i)
        all.flux[i] += batch.flux[i], all.square[i] += batch.square[i];
    }
  }
  before_ = before;
  for (std::size_t k = 0; k < cells.size(); ++k) {
    double flux = 0;
    for (std::size_t i = 0; i < lights.size(); ++i) flux += all.flux[k * lights.size() + i];
    if (!(flux > 0)) continue;
    for (std::size_t i = 0; i < lights.size(); ++i)
      squares_[lights[i]] += cells[k].weight * all.square[k * lights.size() + i] / (flux * flux);
  }
}

std::vector<formats::ViewLight> SharePilot::shares() const {
  double sum = 0;
  for (const auto& [node, square] : squares_) sum += std::sqrt(square);
  std::vector<formats::ViewLight> shares;
  // A share is rounded to a power of two, so that a small change of the scene keeps it. Lights that get less than a
  // pilot path's part of the photons are left out.
  for (const auto& [node, square] : squares_)
    if (const double share = std::sqrt(square) / sum; share > 1.0 / double(kPilotPaths))
      shares.push_back({node, std::exp2(std::round(std::log2(share)))});
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
  const std::vector<std::uint32_t> nodes = nodes_of_slots(frame, table);
  const std::map<std::uint32_t, double> before = share_of_nodes(table, nodes);
  std::map<std::uint32_t, double> wanted;
  double sum = 0;
  for (const formats::ViewLight& light : shares)
    if (before.contains(light.node)) wanted[light.node] += light.share, sum += light.share;
  if (!(sum > 0)) return;
  for (std::size_t slot = 0; slot < nodes.size(); ++slot) {
    double& p = table.probability[slot];
    if (!(p > 0)) continue;
    const auto found = wanted.find(nodes[slot]);
    const double guided = found == wanted.end() ? 0 : found->second / sum * p / before.at(nodes[slot]);
    p = double(kUnguidedShare) * p + (1 - double(kUnguidedShare)) * guided;
  }
}

}  // namespace tempolux
