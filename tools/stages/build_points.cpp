#include "tools/stages/build_points.h"

#include <array>

#include "formats/error.h"
#include "lib/scene/static_scene.h"

namespace tempolux::tools {
namespace {

GatherPoints counted(Tool& tool, GatherPoints points) {
  tool.stats().count("points", double(points.points.size()));
  return points;
}

}  // namespace

GatherPoints points_of_photons(Tool& tool, const std::string& file, const Tracer& tracer, const Lights& lights,
                               const PointOptions& options) {
  tool.stats().phase("read photons");
  const formats::PhotonMap map = read_photons(tool, file, tracer.frame(), {});
  tool.stats().phase("points", true);
  return counted(tool, make_points(map, tracer, lights, options));
}

DividedGatherPoints points_of_parts(Tool& tool, const CacheOptions& options, const Tracer& tracer,
                                    const Lights& lights) {
  tool.stats().phase("read photons");
  const SceneFrame& frame = tracer.frame();
  const DividedPhotonMap map = read_divided_photons(tool, frame_name(options.photons, frame.frame),
                                                    frame_name(options.high, frame.frame), frame, LightNeeded::all);
  tool.stats().phase("points", true);
  DividedGatherPoints divided = make_points(map, tracer, lights, options.points_of(frame));
  divided.whole = counted(tool, std::move(divided.whole));
  return divided;
}

void build_static_points(Tool& tool, SceneInput& input, const CacheOptions& options, int number) {
  Output output(frame_name(options.output, number));
  tool.stats().phase("evaluate");
  const SceneFrame frame = static_scene_of(input.at(number));
  tool.stats().phase("build");
  const Tracer tracer(frame);
  const Lights lights(frame, input.emission(frame.frame));
  tool.stats().phase("read photons");
  const formats::PhotonMap map = read_photons(tool, frame_name(options.photons, number), frame, {.map = "static"});
  tool.stats().phase("points", true);
  const GatherPoints points = counted(tool, make_points(map, tracer, lights, options.points_of(frame)));
  tool.stats().phase("write");
  write_points(tool, points, frame, output, std::array{frame.segment.first, frame.segment.last});
}

void build_updated_points(Tool& tool, SceneInput& input, const CacheOptions& options, int number, StaticTree& tree) {
  Output output(frame_name(options.output, number));
  tool.stats().phase("evaluate");
  const SceneFrame frame = input.at(number), static_frame = static_scene_of(frame);
  const EmissionTable& emission = input.emission(frame.frame);
  tool.stats().phase("build");
  const Tracer whole(frame, tree), without(static_frame, tree);
  const Lights lights(frame, emission);
  tool.stats().phase("read points");
  GatherPoints points = read_points(tool, frame_name(options.update, number), static_frame);
  tool.stats().phase("read photons");
  const std::string dynamic = frame_name(options.dynamic.front(), number);
  const formats::PhotonMap moved = read_photons(tool, dynamic, frame, {.map = "dynamic"});
  const formats::PhotonMap fixed =
      read_photons(tool, frame_name(options.photons, number), static_frame,
                   {.map = "static", .keep = static_photons_read(frame, options.point, points.points, moved.photons)});
  if (moved.header.emitted_count != fixed.header.emitted_count || moved.header.group_count != fixed.header.group_count)
    throw InputError(dynamic + ": of " + std::to_string(moved.header.emitted_count) + " paths, and the static map of " +
                     std::to_string(fixed.header.emitted_count) + "; trace it with the .paths file of that map");
  tool.stats().phase("points", true);
  const PointUpdateCounts counts =
      update_points({fixed, moved}, whole, without, lights, options.points_of(frame), points);
  points = counted(tool, std::move(points));
  tool.stats().phase("write");
  points.history = points.history + moved.header.history;
  write_points(tool, points, frame, output);
  tool.stats().count("direct_sampled", double(counts.direct));
  tool.stats().count("points_changed", double(counts.changed));
  tool.stats().count("points_anew", double(counts.anew));
}

void build_points(Tool& tool, SceneInput& input, const CacheOptions& options, int number, StaticTree& tree) {
  Output output(frame_name(options.output, number));
  tool.stats().phase("evaluate");
  const SceneFrame frame = input.at(number);
  tool.stats().phase("build");
  const Tracer tracer(frame, tree);
  const Lights lights(frame, input.emission(frame.frame));
  const GatherPoints points = options.high.empty() ? points_of_photons(tool, frame_name(options.photons, number),
                                                                       tracer, lights, options.points_of(frame))
                                                   : points_of_parts(tool, options, tracer, lights).whole;
  tool.stats().phase("write");
  write_points(tool, points, frame, output);
}

}  // namespace tempolux::tools
