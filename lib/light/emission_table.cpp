// lib/light/emission_table.cpp -- builds the emission table of a segment.
#include <algorithm>
#include <vector>

#include "formats/hash.h"
#include "lib/core/pi.h"
#include "lib/core/check.h"
#include "lib/core/statistics.h"
#include "lib/light/lights.h"
#include "lib/light/punctual.h"
#include "lib/light/triangle_light.h"

namespace tempolux {
namespace {

/// Parts of all triangles whose emission varies, beside one for each triangle. Bounds memory, to 16 MB, and the time of
/// each tool that builds lights.
constexpr double kMostParts = 0x1p16;

/// Raises `weights`, the largest weight of each slot over several frames, by the weights of one more frame.
void join_weights(const SceneFrame& frame, const EmissionTable& table, std::vector<double>& weights) {
  std::size_t slot = 0;
  const auto join = [&](Rgbd flux) {
    if (slot == weights.size()) weights.push_back(0);
    weights[slot] = std::max(weights[slot], emission_weight(flux));
    ++slot;
  };
  for (std::size_t i = 0; i < table.surfaces.size(); ++i)
    for (const TriangleLight& light : triangle_lights(table, i, frame)) join(light.flux());
  for (const PlacedLight& placed : frame.lights) join(PunctualSource::flux(placed.light, table.sphere_radius));
}

/// Appends the environment's weight to the weights of the other slots. Most of the flux may fall outside of the
/// picture, so a share by flux may mislead: the environment and the others each get at least kUnguidedShare.
void add_environment(const EmissionTable& table, std::vector<double>& weights) {
  const double disc = kPiD * table.sphere_radius * table.sphere_radius;
  double weight = emission_weight(table.environment->integral() * disc), others = 0;
  for (const double w : weights) others += w;
  if (weight > 0 && others > 0)
    weight = std::clamp(weight, others * kUnguidedShare / (1 - kUnguidedShare),
                        others * (1 - kUnguidedShare) / kUnguidedShare);
  weights.push_back(weight);
}

/// True if the flux of any slot may differ between two frames.
bool any_flux_changes(const SceneFrame& frame) {
  if (std::ranges::any_of(frame.segment.changes, [](const PropertyChange& c) { return c.carries != "camera"; }))
    return true;
  if (frame.segment.hides_at_times) return true;
  for (std::size_t s = frame.static_count; s < frame.surfaces.size(); ++s)
    if (frame.materials[frame.surfaces[s].material].emissive()) return true;
  return false;  // the flux of a punctual light does not depend on its position
}

/// Divides the surfaces' triangles. All parts together are limited; a triangle gets a share of them by its flux.
void divide_parts(const SceneFrame& frame, const std::vector<std::uint32_t>& surfaces,
                  std::vector<EmissionParts>& parts) {
  std::vector<std::vector<double>> weights(parts.size());
  double sum = 0;
  for (std::size_t i = 0; i < parts.size(); ++i) {
    if (!parts[i].vary()) continue;
    for (const EmissionPart& part : parts[i].all()) {
      const Surface& surface = frame.surfaces[surfaces[i]];
      weights[i].push_back(TriangleLight(surface, part.triangle, Material()).area * max_component(part.share));
      sum += weights[i].back();
    }
  }
  if (!(sum > 0)) return;
  for (std::size_t i = 0; i < parts.size(); ++i) {
    if (!parts[i].vary()) continue;
    for (double& weight : weights[i]) weight *= kMostParts / sum;
    parts[i].divide(frame, surfaces[i], weights[i]);
  }
}

}  // namespace

double emission_weight(Rgbd flux) { return std::max(luminance(flux), 0.05 * max_component(flux)); }

std::vector<TriangleLight> triangle_lights(const EmissionTable& table, std::size_t index, const SceneFrame& frame) {
  const std::uint32_t s = table.surfaces[index];
  const EmissionParts own = table.parts[index]->hold_at(frame, s) ? EmissionParts() : table.parts[index]->at(frame, s);
  const EmissionParts& parts = own.all().empty() ? *table.parts[index] : own;
  std::vector<TriangleLight> lights;
  lights.reserve(parts.all().size());
  for (const EmissionPart& part : parts.all()) lights.emplace_back(frame, s, part, parts.vary());
  return lights;
}

EmissionTable build_emission_table(std::span<const SceneFrame> frames) {
  TEMPOLUX_CHECK(!frames.empty());
  const SceneFrame& any = frames.front();
  EmissionTable table;
  std::vector<EmissionParts> parts;
  if (!any.bounds.empty()) {
    table.sphere_centre = (Vec3d(any.bounds.lower) + Vec3d(any.bounds.upper)) * 0.5;
    table.sphere_radius = 0.5 * length(Vec3d(any.bounds.upper) - Vec3d(any.bounds.lower)) * (1 + 1e-5);
  }
  for (std::uint32_t s = 0; s < any.surfaces.size(); ++s) {
    const bool emits = std::any_of(frames.begin(), frames.end(),
                                   [&](const SceneFrame& f) { return f.materials[f.surfaces[s].material].emissive(); });
    if (!emits) continue;
    table.surfaces.push_back(s);
    parts.emplace_back(any, s);
  }
  divide_parts(any, table.surfaces, parts);
  for (EmissionParts& of : parts) table.parts.push_back(std::make_shared<const EmissionParts>(std::move(of)));
  std::vector<double> weights;
  for (const SceneFrame& frame : frames) {
    TEMPOLUX_CHECK(frame.surfaces.size() == any.surfaces.size() && frame.lights.size() == any.lights.size());
    join_weights(frame, table, weights);
  }
  if (any.environment) {
    table.environment = std::make_shared<const EnvironmentLight>(*any.environment);
    add_environment(table, weights);
  }
  double total = 0;
  for (const double w : weights) total += w;
  for (double& w : weights) w = total > 0 ? w / total : 1.0 / double(weights.size());
  table.probability = std::move(weights);
  return table;
}

EmissionTable build_emission_table(const Scene& scene, const Segment& segment, const TimeOptions& options) {
  const SegmentScene stage(scene, segment, options);
  std::vector<SceneFrame> frames;
  frames.push_back(stage.at(segment.first));
  if (any_flux_changes(frames.front()))
    for (int f = segment.first + 1; f <= segment.last; ++f) frames.push_back(stage.at(f));
  return build_emission_table(frames);
}

std::string emission_hash(const EmissionTable& table, const Segment& segment) {
  Hasher hasher;
  hasher.add_array(std::span<const double>(table.probability));
  hasher.add(table.sphere_centre);
  hasher.add(table.sphere_radius);
  hasher.add(segment.origin);
  hasher.add(segment.world_bounds.lower);
  hasher.add(segment.world_bounds.upper);
  for (const auto* spheres : {&table.aim, &table.openings})
    for (const AimSphere& sphere : *spheres) {
      hasher.add(sphere.centre);
      hasher.add(sphere.radius);
      hasher.add(sphere.weight);
    }
  return hasher.hex();
}

}  // namespace tempolux
