// irradcache-build -- irradiance points over the surfaces, and irradiance records where a camera needs them.
//
//     irradcache-build points  room.glb --frame 12 --photons p.0012.photons -o p.0012.irradpoints
//     irradcache-build points  room.glb --frame 0 --map static --photons s.photons -o s.irradpoints
//     irradcache-build points  room.glb --frame 12 --update s.irradpoints --photons s.photons --dynamic d.photons
//                              -o p.0012.irradpoints
//     irradcache-build records room.glb --frame 12 --points p.0012.irradpoints --size 960x540 -o c.0012.irradcache
//     irradcache-build         room.glb --frame 12 --photons p.0012.photons --size 960x540 -o c.0012.irradcache
//     irradcache-build         hall.glb --frames 0-47 --photons p.photons --size 960x540 -o c.irradcache
//
// Formats: formats/irradpoints/irradpoints.md, formats/irradcache/irradcache.md.
#include <algorithm>
#include <optional>
#include <string>
#include <vector>

#include "formats/error.h"
#include "tools/common/cli.h"
#include "tools/common/tool_main.h"
#include "tools/stages/build_records.h"
#include "tools/stages/importance.h"

using namespace tempolux;

namespace {

constexpr std::uint64_t kMaxPoints = 1 << 28;  ///< per side of all surfaces

using Options = tools::CacheOptions;

/// Refuses options that the step does not read: without an error they would have no effect.
void refuse_unread(const CLI::App& app, const std::string& step, const std::vector<std::string>& names) {
  for (const std::string& name : names)
    if (app.get_option(name)->count() > 0) throw InputError(name + ": " + step + " does not read it; leave it out");
}

void check(tools::Tool& tool, const Options& options) {
  const CLI::App& app = tool.app();
  const std::string mode = options.mode();
  if (mode != "both" && mode != "points" && mode != "records")
    throw InputError("'" + options.inputs[0] + "' is not a step: it is points, records, or nothing for both");
  if (mode == "points" && options.photons.empty()) throw InputError("points: name the photon map with --photons FILE");
  if (mode == "records" && options.points.empty()) throw InputError("records: name the points with --points FILE");
  if (mode == "both" && options.photons.empty() == options.points.empty())
    throw InputError("name either the photon map, --photons FILE, or the points made from it, --points FILE");
  if (mode == "both") refuse_unread(app, "a run without a step", {"--map", "--update", "--dynamic"});
  if (mode == "records" && !options.update.empty()) refuse_unread(app, "records --update", {"--high"});
  if (!options.high.empty() && (!options.update.empty() || options.map == "static"))
    throw InputError(
        "--high: parts of light are those of a whole scene's map; leave out --update and --map static, or give the "
        "whole");
  if (mode == "points" && options.dynamic.size() > 1)
    throw InputError("--dynamic: points take one map, that of their frame");
  if (options.update.empty() != options.dynamic.empty())
    throw InputError("--update and --dynamic go together: static points, and the change that movers make");
  if (!options.update.empty() && options.map == "static")
    throw InputError("--update: makes points of the whole scene; leave out --map static");
  if (mode == "points")
    refuse_unread(app, "points", {"--points", "--rays", "--error-bound", "--size", "--keep-points"});
  else if (!options.points.empty())
    refuse_unread(app, "a run with --points",
                  {"--photons", "--importance", "--point-count", "--light-samples", "--keep-points"});
  if (options.point_count < 1 || options.point_count > kMaxPoints)
    throw InputError("--point-count: " + std::to_string(options.point_count) + " is not from 1 to " +
                     std::to_string(kMaxPoints));
  if (mode == "points") tool.check_patterns({options.output});
}

void add_options(tools::Tool& tool, Options& options) {
  CLI::App& app = tool.app();
  app.add_option("scene", options.inputs, "glTF 2.0 scene; the word points or records before it makes only these")
      ->required()
      ->expected(1, 2)
      ->type_name("[points|records] SCENE");
  tool.file_option("--photons", options.photons, ".photons file of this frame with caustic and indirect light");
  tool.file_option("--points", options.points, ".irradpoints file of this frame, instead of --photons");
  tool.file_option("--high", options.high,
                   "high part from photonmap-split; --points or --photons is then the low part, in the same format. "
                   "Records sample bright points explicitly; points hold the light of both parts");
  tool.count_option("--point-count", options.point_count,
                    "irradiance points per side of all static surfaces; movers get as many per area");
  tool.file_option("--importance", options.importance, tools::kImportanceHelp);
  tool.choice_option("--map", options.map, {"global", "static"},
                     "global: the scene at the frame; static: points and records of the static scene of the frame's "
                     "segment, from its static map and points");
  tool.file_option(
      "--update", options.update,
      "static file to update to this frame: .irradpoints, with --photons (the static map) and --dynamic; or "
      ".irradcache, with --points and --dynamic");
  tool.file_option(
      "--dynamic", options.dynamic,
      "with --update: .photons file of this frame from photon-trace --map dynamic. For records the files of earlier "
      "frames may follow: where movers changed the light in those frames, records are gathered anew, too");
  tool.number_option("--light-samples", options.light_samples, 0, 4096,
                     "shadow rays per point for direct light; 0: 4, or 16 where light of sun and sky passes openings");
  tool.number_option("--rays", options.gather.rays, 1, 1 << 20,
                     "gather rays per record, one through each cell of its hemisphere");
  tool.number_option("--error-bound", options.placement.error_bound, 1e-3, 2.0,
                     "radius of a record divided by the harmonic mean distance of the surfaces that it sees: smaller "
                     "values give more records");
  tool.size_option("--size", options.width, options.height, "picture for which records are placed, pixels");
  tool.output_option(options.keep_points, "also write the points made from --photons, .irradpoints", "--keep-points");
  tool.output_option(options.output, ".irradcache file (points: .irradpoints); - for standard output")->required();
}

}  // namespace

int main(int argc, char** argv) {
  tools::Tool tool("irradcache-build",
                   "Spread irradiance points over the surfaces; gather irradiance records where a camera needs them.",
                   argc, argv);
  Options options;
  add_options(tool, options);
  tool.common_options(tools::uses_scene | tools::uses_seed | tools::uses_camera | tools::uses_frames);

  return tool.run([&] {
    const std::vector<int>& frames = tool.common().frames;
    check(tool, options);
    options.point.count = std::uint32_t(options.point_count);
    const bool makes_points = options.mode() == "points" || !options.photons.empty();
    std::optional<tools::Importance> importance;
    // Options with the frame's seed, the same for a single frame and for a range.
    const auto seeded = [&](int frame) -> const Options& {
      options.point.seed = options.gather.seed = tool.common().seed_for_frame(frame);
      if (makes_points) options.take(importance->at(frame));
      return options;
    };
    tool.stats().phase("load");
    const unsigned camera = options.mode() == "points" && !options.importance.empty() ? tools::SceneInput::nothing
                                                                                      : tools::SceneInput::a_camera;
    tools::SceneInput input(tool, options.scene(), tools::SceneInput::light | camera);
    importance.emplace(tool, input, options.importance, "indirect");
    StaticTree tree;
    if (options.mode() == "points")
      for (int frame : frames)
        if (options.map == "static") tools::build_static_points(tool, input, seeded(frame), frame);
        else if (!options.update.empty()) tools::build_updated_points(tool, input, seeded(frame), frame, tree);
        else tools::build_points(tool, input, seeded(frame), frame, tree);
    else if (!options.update.empty() && !tools::has_frame_pattern(options.output))
      tools::build_updated_records(tool, input, seeded(frames.front()), frames, tree);
    else if (!options.update.empty())
      for (int frame : frames) tools::build_updated_records(tool, input, seeded(frame), {frame}, tree);
    else tools::build_records(tool, input, seeded(frames.front()), frames);
    return tools::exit_ok;
  });
}
