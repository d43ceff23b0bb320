// photon-trace -- trace photons from the lights of a scene and record where they arrive.
//
//     photon-trace room.glb --frame 12 --photons 1M -o photons.0012.photons
//     photon-trace room.glb --frames 0-47 --photons 1M -o photons.####.photons
//     photon-trace room.glb --frame 0 --map static --photons 1M -o s.photons --paths s.paths
//     photon-trace room.glb --frames 0-23 --map dynamic --static s.paths -o d.####.photons
//     photon-trace room.glb --frames 1-23 --majorants m --update p.####.photons --share 10% --strategy census
//                  -o p.####.photons
//
// Formats: formats/photons/photons.md, formats/paths/paths.md. Method: docs/methods/dynamic.md.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "formats/hash.h"
#include "formats/paths/paths.h"
#include "formats/photons/layout.h"
#include "lib/photon/dynamic_map.h"
#include "lib/photon/photon_map.h"
#include "lib/render/seen_spheres.h"
#include "lib/scene/static_scene.h"
#include "tools/common/option_words.h"
#include "tools/common/scene_input.h"
#include "tools/common/tool_main.h"
#include "tools/stages/importance.h"
#include "tools/stages/update_photons.h"

using namespace tempolux;

namespace {

struct Options {
  std::string scene, output, photons = "1M", kinds = "direct,caustic,indirect", map = "global", importance, paths,
                             static_paths;
  tools::UpdateArguments updating;
};

/// A density estimate from this many photons has a standard error of 14 %. With fewer photons in each sphere, estimates
/// also take light from outside the sphere.
constexpr std::uint64_t kNeededPerSphere = 50;

void warn_of_few(tools::Tool& tool, const Lights& lights, const PhotonMapResult& result, int frame_number) {
  const std::uint64_t needed = kNeededPerSphere * lights.aim().size(), seen = result.seen_count;
  tool.stats().count("photons_seen", double(seen));
  if (seen >= needed) return;
  tool.warn(
      "frame " + std::to_string(frame_number) + ": only " + std::to_string(seen) +
      " photons lie where the cameras look, " + std::to_string(needed) + " are needed: indirect light will be rough; " +
      (seen == 0 ? "start more with --photons"
                 : "start " + std::to_string((result.path_count * needed + seen - 1) / seen) + " with --photons"));
}

void count(tools::Tool& tool, const PhotonMapResult& result, const tools::Output& output, std::uint64_t refused) {
  tool.stats().count("photons", double(result.totals.photon_count));
  tool.stats().count("paths", double(result.path_count));
  tool.stats().count("rays", double(result.ray_count));
  tool.stats().count("specular_rays", double(result.specular_ray_count));
  if (result.medium_steps > 0) tool.stats().count("medium_steps", double(result.medium_steps));
  tool.stats().count("bytes_written", double(output.written()));
  tool.stats().count("refused_rays", double(refused));
}

formats::PhotonHeader header_of(const tools::Tool& tool, const SceneFrame& frame, const EmissionTable& emission,
                                int number) {
  formats::PhotonHeader header;
  header.history = tool.history_line(number);
  header.identity = identity_of(frame);
  header.identity.emission = emission_hash(emission, frame.segment);
  header.origin = {frame.origin.x, frame.origin.y, frame.origin.z};
  return header;
}

PhotonOptions photon_options_of(const tools::Tool& tool, const Options& options, int frame_number) {
  PhotonOptions photon_options;
  photon_options.seed = tool.common().seed_for_frame(frame_number);
  photon_options.photon_count = tools::parse_count(options.photons);
  photon_options.set_kinds(options.kinds);
  return photon_options;
}

void trace_frame(tools::Tool& tool, tools::SceneInput& input, const Options& options,
                 const std::vector<formats::ViewSphere>& view, int frame_number, StaticTree& standing,
                 tools::KeptMap& kept) {
  tools::Output output(tools::frame_name(options.output, frame_number));
  tool.stats().phase("evaluate");
  const SceneFrame frame = input.at(frame_number);
  EmissionTable emission = input.emission(frame.frame);
  emission.aim = spheres_in_scene(view, frame.origin);
  tool.stats().phase("build");
  const Tracer tracer(frame, standing);
  const Lights lights(frame, emission);

  PhotonOptions photon_options = photon_options_of(tool, options, frame_number);
  photon_options.pilots = tools::pilots_of(options.updating, photon_options, frame.frame);
  const formats::PhotonHeader header = header_of(tool, frame, emission, frame_number);

  tool.stats().phase("trace", true);
  const PhotonTracer photons(tracer, lights, photon_options);
  const PhotonMapResult result =
      options.updating.updates()
          ? update_map(tool, options.updating,
                       {frame, photons, photon_options, header, tools::frame_name(options.output, frame.frame)},
                       output.sink(), kept)
          : write_photon_map(photons, photon_options, header, output.sink(),
                             [&](double fraction) { tool.progress(fraction); });
  tool.stats().phase("commit");
  output.commit();
  tool.stats().end_phase();
  if (!lights.aim().empty() && !options.updating.updates()) warn_of_few(tool, lights, result, frame_number);
  count(tool, result, output, tracer.refused_ray_count());
}

/// The movers in one interval of a segment: their boxes, and a hash of their states.
struct Movers {
  MovingBoxes boxes;
  std::string hash;
};

/// Interval i of `intervals`: all frames f of the segment with interval_of(f) == i.
Movers movers_in(tools::SceneInput& input, const Segment& segment, std::size_t i, std::size_t intervals) {
  Movers movers;
  Hasher hasher;
  for (int f = segment.first; f <= segment.last; ++f) {
    if (formats::interval_of(f, segment.first, segment.last, intervals) != i) continue;
    const SceneFrame frame = input.at(f, false);
    movers.boxes.add(moving_boxes(frame));
    for (const std::string& hash : {frame.hashes.moving_geometry, frame.hashes.lights, frame.hashes.materials})
      hasher.add(std::string_view(hash));
  }
  movers.hash = hasher.hex();
  return movers;
}

/// Traces the static map of a segment and finds its touched paths.
void trace_static(tools::Tool& tool, tools::SceneInput& input, const Options& options,
                  const std::vector<formats::ViewSphere>& view, int frame_number) {
  tools::Output output(tools::frame_name(options.output, frame_number));
  std::optional<tools::Output> paths_output;
  if (!options.paths.empty()) paths_output.emplace(tools::frame_name(options.paths, frame_number));
  tool.stats().phase("evaluate");
  const SceneFrame frame = static_scene_of(input.at(frame_number));
  const Segment& segment = frame.segment;
  const std::size_t intervals =
      std::min<std::size_t>(formats::kMostIntervals, std::size_t(segment.last - segment.first + 1));
  std::vector<MovingBoxes> boxes;
  std::vector<std::string> hashes;
  for (std::size_t i = 0; paths_output && i < intervals; ++i) {
    const Movers movers = movers_in(input, segment, i, intervals);
    boxes.push_back(movers.boxes);
    hashes.push_back(movers.hash);
  }
  EmissionTable emission = input.emission(frame.frame);
  emission.aim = spheres_in_scene(view, frame.origin);
  tool.stats().phase("build");
  const Tracer tracer(frame);
  const Lights lights(frame, emission);

  PhotonOptions photon_options = photon_options_of(tool, options, frame_number);
  formats::PhotonHeader header = header_of(tool, frame, emission, frame_number);
  header.map = "static";
  header.identity.first_frame = segment.first;
  header.identity.last_frame = segment.last;

  tool.stats().phase("trace", true);
  PhotonTracer photons(tracer, lights, photon_options);
  std::optional<MoverWatch> watch;
  if (paths_output) photons.watch(&watch.emplace(std::move(boxes)));
  const PhotonMapResult result = write_photon_map(photons, photon_options, header, output.sink(),
                                                  [&](double fraction) { tool.progress(fraction); });
  tool.stats().phase("commit");
  if (paths_output) {
    formats::PathsHeader paths;
    paths.history = header.history;
    paths.identity = header.identity;
    paths.origin = header.origin;
    paths.group_count = photons.group_count();
    paths.emitted_count = photons.photon_count();
    paths.seed = photon_options.seed;
    paths.kinds = photon_options.kinds();
    paths.movers = hashes;
    formats::PathsWriter writer(paths_output->sink(), paths);
    writer.write(result.touched);
    writer.finish();
    paths_output->commit();
    tool.stats().count("touched_paths", double(result.touched.size()));
  }
  output.commit();
  tool.stats().end_phase();
  if (!lights.aim().empty()) warn_of_few(tool, lights, result, frame_number);
  count(tool, result, output, tracer.refused_ray_count());
}

/// Refuses touched paths of another segment, another static scene or other movers.
void check_paths(tools::Tool& tool, tools::SceneInput& input, const std::string& file,
                 const formats::PathsHeader& paths, const SceneFrame& standing, const std::string& emission,
                 int frame) {
  const Segment segment = standing.segment;
  if (paths.identity.first_frame != segment.first || paths.identity.last_frame != segment.last)
    throw InputError(file + ": holds for the segment of frames " + std::to_string(paths.identity.first_frame) + " to " +
                     std::to_string(paths.identity.last_frame) + ", and frame " + std::to_string(frame) + " lies in " +
                     std::to_string(segment.first) + " to " + std::to_string(segment.last) +
                     "; trace the static map of that one");
  tools::check_identity(tool, file, paths.identity, standing);
  std::string stale;
  if (!paths.identity.emission.empty() && paths.identity.emission != emission)
    stale = "emission (lights, or what --importance aims at)";
  const std::size_t interval = formats::interval_of(frame, segment.first, segment.last, paths.movers.size());
  if (movers_in(input, segment, interval, paths.movers.size()).hash != paths.movers[interval])
    stale += (stale.empty() ? "" : ", ") + std::string("what moves");
  if (!stale.empty())
    throw InputError(file + ": made for another state of the scene: " + stale + " differ at frame " +
                     std::to_string(frame) + "; trace the static map again");
}

/// Traces the dynamic map of a frame: the touched paths with and without the movers.
void trace_difference(tools::Tool& tool, tools::SceneInput& input, const Options& options,
                      const std::vector<formats::ViewSphere>& view, int frame_number, StaticTree& tree) {
  tools::Output output(tools::frame_name(options.output, frame_number));
  const std::string file = tools::frame_name(options.static_paths, frame_number);
  tool.stats().phase("read paths");
  tool.depends_on(file);
  const formats::PathsFile paths = formats::load_paths(file);
  tool.stats().phase("evaluate");
  const SceneFrame frame = input.at(frame_number);
  const SceneFrame standing = static_scene_of(frame);
  EmissionTable emission = input.emission(frame.frame);
  emission.aim = spheres_in_scene(view, frame.origin);
  check_paths(tool, input, file, paths.header, standing, emission_hash(emission, frame.segment), frame.frame);
  if (tool.app().get_option("--seed")->count() > 0 && tool.common().seed != paths.header.seed)
    throw InputError("--seed " + std::to_string(tool.common().seed) +
                     ": of --map dynamic the static map has it: " + std::to_string(paths.header.seed));
  const Segment& segment = frame.segment;
  const std::uint64_t bit =
      std::uint64_t(1) << formats::interval_of(frame.frame, segment.first, segment.last, paths.header.movers.size());
  std::vector<std::uint64_t> touched;
  for (const formats::TouchedPath& path : paths.paths)
    if (path.intervals & bit) touched.push_back(path.path);
  tool.stats().phase("build");
  const Tracer tracer(frame, tree), static_tracer(standing, tree);
  const Lights lights(frame, emission), static_lights(standing, emission);

  PhotonOptions photon_options;
  photon_options.seed = paths.header.seed;
  photon_options.photon_count = paths.header.emitted_count;
  photon_options.group_count = paths.header.group_count;
  photon_options.set_kinds(paths.header.kinds);
  formats::PhotonHeader header = header_of(tool, frame, emission, frame_number);
  header.map = "dynamic";

  tool.stats().phase("trace", true);
  const PhotonTracer whole(tracer, lights, photon_options), without(static_tracer, static_lights, photon_options);
  const PhotonMapResult result = write_dynamic_map(without, whole, touched, photon_options, header, output.sink(),
                                                   [&](double fraction) { tool.progress(fraction); });
  tool.stats().phase("commit");
  output.commit();
  tool.stats().end_phase();
  count(tool, result, output, tracer.refused_ray_count() + static_tracer.refused_ray_count());
  tool.stats().count("touched_paths", double(touched.size()));
}

void check(const CLI::App& app, const Options& options) {
  if (options.map != "static" && !options.paths.empty()) throw InputError("--paths: only with --map static");
  if (options.map != "dynamic" && !options.static_paths.empty()) throw InputError("--static: only with --map dynamic");
  if (options.map != "dynamic") return;
  if (options.static_paths.empty())
    throw InputError("--map dynamic needs --static: the .paths file that --map static --paths has written");
  for (const char* name : {"--photons", "--kinds"})
    if (app.get_option(name)->count() > 0)
      throw InputError(std::string(name) + ": of --map dynamic the static map has it");
}

}  // namespace

int main(int argc, char** argv) {
  tools::Tool tool("photon-trace", "Trace photons from the lights of a scene and record where they arrive.", argc,
                   argv);
  Options options;
  CLI::App& app = tool.app();
  app.add_option("scene", options.scene, "glTF 2.0 scene, .gltf or .glb")->required();
  app.add_option("--photons", options.photons,
                 "photon paths to start per frame (10k, 1M, 1G), rounded up to a multiple of their number of groups")
      ->capture_default_str();
  app.add_option(
         "--kinds", options.kinds,
         "kinds of light to record: direct,caustic,indirect, and volume, which is recorded where there is a medium")
      ->capture_default_str();
  tool.file_option("--importance", options.importance, tools::kImportanceHelp);
  app.add_option("-o,--output", options.output, ".photons file, or a pattern as f.####.photons; - for standard output")
      ->required();
  tool.choice_option("--map", options.map, {"global", "static", "dynamic"},
                     "global: the scene at the frame; static: without movers of the frame's segment; dynamic: the "
                     "difference, for touched paths");
  tool.output_option(options.paths, "with --map static: also write the paths that movers can touch, .paths", "--paths");
  tool.file_option("--static", options.static_paths, "with --map dynamic: the .paths file of the segment's static map");
  tools::add_update_options(tool, options.updating);
  tool.common_options(tools::uses_scene | tools::uses_majorants | tools::uses_seed | tools::uses_camera |
                      tools::uses_frames);

  return tool.run([&] {
    check(app, options);
    const std::vector<int>& frames = tool.common().frames;
    tool.check_patterns({options.output});
    tools::check_update_arguments(tool, options.map != "global", options.updating);
    tool.stats().phase("load");
    const unsigned camera = options.importance.empty() ? tools::SceneInput::a_camera : tools::SceneInput::nothing;
    tools::SceneInput input(tool, options.scene, tools::SceneInput::light | camera);
    if (options.map != "global" && input.has_media())
      throw InputError(options.scene + ": has media, which all light meets: --map " + options.map +
                       " cannot be separated from the remaining light; trace the global map");
    StaticTree standing;
    tools::Importance importance(tool, input, options.importance);
    tools::KeptMap kept;
    for (int frame : frames) {
      kept.wanted = frame != frames.back();
      const std::vector<formats::ViewSphere>& view = importance.at(frame);
      if (options.map == "static") trace_static(tool, input, options, view, frame);
      else if (options.map == "dynamic") trace_difference(tool, input, options, view, frame, standing);
      else trace_frame(tool, input, options, view, frame, standing, kept);
    }
    return tools::exit_ok;
  });
}
