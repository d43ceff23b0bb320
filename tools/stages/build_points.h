// tools/stages/build_points.h -- irradcache-build: options, and irradiance points of a frame, of the static scene, or
// updated.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "lib/gather/localised.h"
#include "lib/gather/place_records.h"
#include "lib/pilot/seen_spheres.h"
#include "tools/stages/gather_input.h"

namespace tempolux::tools {

/// Shadow rays of a point where light passes openings. Measured in S8 (docs/methods/records.md): 4 leave light of
/// points whose noise all records share.
inline constexpr int kOpeningSamples = 16;

/// The options of irradcache-build.
struct CacheOptions {
  std::vector<std::string> inputs;  ///< [points|records] SCENE
  std::string photons, points, importance, high, output, keep_points, map = "global", update;
  std::vector<std::string> dynamic;  ///< the frame's own map comes first
  std::uint64_t point_count = PointOptions{}.count;
  std::vector<formats::ViewSphere> view;  ///< spheres that --importance names
  int light_samples = 0;                  ///< of a point; 0: those that suit the view
  int width = 640, height = 360;
  PointOptions point;
  GatherOptions gather;
  PlacementOptions placement;

  /// "points", "records", or "both" without a step.
  std::string mode() const { return inputs.size() == 2 ? inputs[0] : "both"; }
  const std::string& scene() const { return inputs.back(); }
  /// Takes the view of a frame. Without --light-samples, points get kOpeningSamples where light of sun and sky passes
  /// openings, since most shadow rays then miss them.
  void take(const formats::View& of_frame) {
    view = of_frame.spheres;
    point.light_samples = light_samples > 0           ? light_samples
                          : of_frame.openings.empty() ? PointOptions{}.light_samples
                                                      : kOpeningSamples;
  }
  /// Options for the points of a frame.
  PointOptions points_of(const SceneFrame& frame) const {
    PointOptions options = point;
    options.seen = spheres_in_scene(view, frame.origin);
    return options;
  }
};

/// Estimates points from a file of photons. One thread reads the file; all threads estimate.
GatherPoints points_of_photons(Tool& tool, const std::string& file, const Tracer& tracer, const Lights& lights,
                               const PointOptions& options);
/// Estimates points from both parts of a divided map: options.photons is the low part, options.high the high part.
DividedGatherPoints points_of_parts(Tool& tool, const CacheOptions& options, const Tracer& tracer,
                                    const Lights& lights);

/// Writes the .irradpoints of a frame from its global map.
void build_points(Tool& tool, SceneInput& input, const CacheOptions& options, int number, StaticTree& tree);
/// Writes the static points of a segment from its static map.
void build_static_points(Tool& tool, SceneInput& input, const CacheOptions& options, int number);
/// Writes the points of a frame: the static points, to which the dynamic map's light is added, and points on the
/// movers.
void build_updated_points(Tool& tool, SceneInput& input, const CacheOptions& options, int number, StaticTree& tree);

}  // namespace tempolux::tools
