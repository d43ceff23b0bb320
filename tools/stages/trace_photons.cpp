#include "tools/stages/trace_photons.h"

#include <algorithm>
#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include "formats/error.h"
#include "formats/hash.h"
#include "formats/photons/layout.h"
#include "lib/core/arrays.h"
#include "lib/photon/dynamic_map.h"
#include "lib/photon/photon_map.h"
#include "lib/pilot/photon_shares.h"
#include "lib/pilot/seen_spheres.h"
#include "lib/scene/static_scene.h"
#include "tools/common/cli.h"

namespace tempolux::tools {
namespace {

/// A density estimate from 50 photons has a standard error of 14 %. If a sphere that cameras see holds fewer photons,
/// estimates in it also use photons outside of it.
constexpr std::uint64_t kNeededPerSphere = 50;

/// The movers in one interval of a segment: their boxes, and a hash of their states.
struct Movers {
  MovingBoxes boxes;
  std::string hash;
};

/// Interval i of `intervals`: all frames f of the segment with interval_of(f) == i.
Movers movers_in(SceneInput& input, const Segment& segment, std::size_t i, std::size_t intervals) {
  Movers movers;
  Hasher hasher;
  for (int f = segment.first; f <= segment.last; ++f) {
    if (formats::interval_of(f, segment.first, segment.last, intervals) != i) continue;
    const SceneFrame frame = input.at(f, false);
    movers.boxes.add(moving_boxes(frame));
    for (const std::string& hash : {frame.hashes.moving_geometry, frame.hashes.lights, frame.hashes.materials})
      hasher.add(hash);
  }
  movers.hash = hasher.hex();
  return movers;
}

/// Writes the touched paths of a static map.
void write_paths(const formats::PhotonHeader& map, const PhotonTracer& photons, const std::vector<std::string>& movers,
                 const std::vector<formats::TouchedPath>& touched, Output& output) {
  formats::PathsHeader paths;
  paths.history = map.history;
  paths.identity = map.identity;
  paths.origin = map.origin;
  paths.group_count = photons.group_count();
  paths.emitted_count = photons.photon_count();
  paths.seed = photons.seed();
  paths.kinds = photons.options().kinds();
  paths.movers = movers;
  formats::PathsWriter writer(output.sink(), paths);
  writer.write(touched);
  writer.finish();
  output.commit();
}

}  // namespace

void PhotonTracing::trace(int frame_number, bool is_last) {
  kept_.wanted = !is_last;
  if (options_.map == "static") trace_static(frame_number);
  else if (options_.map == "dynamic") trace_dynamic(frame_number);
  else trace_global(frame_number);
}

/// The emission table of the frame, with distant light aimed where the cameras look, and photons for every light by
/// what they bring into view.
EmissionTable PhotonTracing::aimed_emission(const SceneFrame& frame, int frame_number) {
  EmissionTable emission = input_.emission(frame.frame);
  const formats::View& view = importance_.at(frame_number);
  emission.aim = spheres_in_scene(view.spheres, frame.origin);
  emission.openings = spheres_in_scene(view.openings, frame.origin);
  give_shares(frame, view.lights, emission);
  return emission;
}

PhotonOptions PhotonTracing::photon_options(int frame_number) const {
  PhotonOptions options;
  options.seed = tool_.common().seed_for_frame(frame_number);
  options.photon_count = options_.photons;
  options.set_kinds(options_.kinds);
  return options;
}

formats::PhotonHeader PhotonTracing::header_of(const SceneFrame& frame, const EmissionTable& emission,
                                               int frame_number) const {
  formats::PhotonHeader header;
  header.history = tool_.history_line(frame_number);
  header.identity = identity_of(frame);
  header.identity.emission = emission_hash(emission, frame.segment);
  header.origin = array_of(frame.origin);
  return header;
}

/// Commits a map, if one is written, and counts the work.
void PhotonTracing::finish(Output* output, const PhotonMapResult& result, std::uint64_t refused_rays) {
  Stats& stats = tool_.stats();
  if (output) output->commit();
  stats.end_phase();
  stats.count("photons", double(result.totals.photon_count));
  stats.count("paths", double(result.path_count));
  stats.count("rays", double(result.ray_count));
  stats.count("specular_rays", double(result.specular_ray_count));
  if (result.medium_steps > 0) stats.count("medium_steps", double(result.medium_steps));
  if (output) stats.count("bytes_written", double(output->written()));
  stats.count("refused_rays", double(refused_rays));
}

/// Warns if too few photons lie where the cameras look.
void PhotonTracing::warn_of_few(const Lights& lights, const PhotonMapResult& result, int frame_number) {
  if (lights.aim().size() == 0) return;
  const std::uint64_t needed = kNeededPerSphere * lights.aim().size(), seen = result.seen_count;
  tool_.stats().count("photons_seen", double(seen));
  if (seen >= needed) return;
  tool_.warn(
      "frame " + std::to_string(frame_number) + ": only " + std::to_string(seen) +
      " photons lie where the cameras look, " + std::to_string(needed) + " are needed: indirect light will be rough; " +
      (seen == 0 ? "start more with --photons"
                 : "start " + std::to_string((result.path_count * needed + seen - 1) / seen) + " with --photons"));
}

void PhotonTracing::trace_global(int frame_number) {
  Output output(frame_name(options_.output, frame_number));
  tool_.stats().phase("evaluate");
  const SceneFrame frame = input_.at(frame_number);
  const EmissionTable emission = aimed_emission(frame, frame_number);
  tool_.stats().phase("build");
  const Tracer tracer(frame, static_tree_);
  const Lights lights(frame, emission);
  PhotonOptions options = photon_options(frame_number);
  set_groups(options_.updating, frame.frame, options);
  const formats::PhotonHeader header = header_of(frame, emission, frame_number);

  tool_.stats().phase("trace", true);
  const PhotonTracer photons(tracer, lights, options);
  const bool updates = options_.updating.updates();
  const PhotonMapResult result =
      updates ? update_map(tool_, options_.updating, {frame, photons, header, frame_name(options_.output, frame.frame)},
                           output.sink(), kept_)
              : write_photon_map(photons, header, output.sink(), tool_.progress_sink());
  tool_.stats().phase("commit");
  finish(&output, result, tracer.refused_ray_count());
  if (!updates) warn_of_few(lights, result, frame_number);
}

/// Traces the static map of a segment and finds its touched paths.
void PhotonTracing::trace_static(int frame_number) {
  std::optional<Output> output, paths_output;
  if (!options_.output.empty()) output.emplace(frame_name(options_.output, frame_number));
  if (!options_.paths.empty()) paths_output.emplace(frame_name(options_.paths, frame_number));
  tool_.stats().phase("evaluate");
  const SceneFrame frame = static_scene_of(input_.at(frame_number));
  const Segment& segment = frame.segment;
  const std::size_t intervals =
      std::min<std::size_t>(formats::kMostIntervals, std::size_t(segment.last - segment.first + 1));
  std::vector<MovingBoxes> boxes;
  std::vector<std::string> hashes;
  for (std::size_t i = 0; paths_output && i < intervals; ++i) {
    const Movers movers = movers_in(input_, segment, i, intervals);
    boxes.push_back(movers.boxes);
    hashes.push_back(movers.hash);
  }
  const EmissionTable emission = aimed_emission(frame, frame_number);
  tool_.stats().phase("build");
  const Tracer tracer(frame);
  const Lights lights(frame, emission);
  const PhotonOptions options = photon_options(frame_number);
  formats::PhotonHeader header = header_of(frame, emission, frame_number);
  header.map = "static";
  header.identity.first_frame = segment.first;
  header.identity.last_frame = segment.last;

  tool_.stats().phase("trace", true);
  PhotonTracer photons(tracer, lights, options);
  std::optional<MoverWatch> watch;
  if (paths_output) photons.watch(&watch.emplace(std::move(boxes)));
  const auto nowhere = [](const void*, std::size_t) {};  // without output the paths alone are wanted
  const PhotonMapResult result = write_photon_map(
      photons, header, output ? output->sink() : formats::ContainerWriter::Sink(nowhere), tool_.progress_sink());
  tool_.stats().phase("commit");
  if (paths_output) {
    write_paths(header, photons, hashes, result.touched, *paths_output);
    tool_.stats().count("touched_paths", double(result.touched.size()));
  }
  finish(output ? &*output : nullptr, result, tracer.refused_ray_count());
  warn_of_few(lights, result, frame_number);
}

/// Refuses touched paths of another segment, another static scene or other movers.
void PhotonTracing::check_paths(const std::string& file, const formats::PathsHeader& paths,
                                const SceneFrame& static_frame, const std::string& emission, int frame) {
  const Segment segment = static_frame.segment;
  if (paths.identity.first_frame != segment.first || paths.identity.last_frame != segment.last)
    throw InputError(file + ": holds for the segment of frames " + std::to_string(paths.identity.first_frame) + " to " +
                     std::to_string(paths.identity.last_frame) + ", and frame " + std::to_string(frame) + " lies in " +
                     std::to_string(segment.first) + " to " + std::to_string(segment.last) +
                     "; trace the static map of that one");
  check_identity(tool_, file, paths.identity, static_frame);
  std::string stale;
  if (!paths.identity.emission.empty() && paths.identity.emission != emission)
    stale = "emission (lights, or what --importance aims at)";
  const std::size_t interval = formats::interval_of(frame, segment.first, segment.last, paths.movers.size());
  if (movers_in(input_, segment, interval, paths.movers.size()).hash != paths.movers[interval])
    stale += (stale.empty() ? "" : ", ") + std::string("what moves");
  if (!stale.empty())
    throw InputError(file + ": made for another state of the scene: " + stale + " differ at frame " +
                     std::to_string(frame) + "; trace the static map again");
}

/// Traces the dynamic map of a frame: the touched paths with and without the movers.
void PhotonTracing::trace_dynamic(int frame_number) {
  Output output(frame_name(options_.output, frame_number));
  const std::string file = frame_name(options_.static_paths, frame_number);
  tool_.stats().phase("read paths");
  tool_.depends_on(file);
  const formats::PathsFile paths = formats::load_paths(file);
  tool_.stats().phase("evaluate");
  const SceneFrame frame = input_.at(frame_number);
  const SceneFrame static_frame = static_scene_of(frame);
  const EmissionTable emission = aimed_emission(frame, frame_number);
  check_paths(file, paths.header, static_frame, emission_hash(emission, frame.segment), frame.frame);
  if (tool_.app().get_option("--seed")->count() > 0 && tool_.common().seed != paths.header.seed)
    throw InputError("--seed " + std::to_string(tool_.common().seed) +
                     ": of --map dynamic the static map has it: " + std::to_string(paths.header.seed));
  const Segment& segment = frame.segment;
  const std::uint64_t bit =
      std::uint64_t(1) << formats::interval_of(frame.frame, segment.first, segment.last, paths.header.movers.size());
  std::vector<std::uint64_t> touched;
  for (const formats::TouchedPath& path : paths.paths)
    if (path.intervals & bit) touched.push_back(path.path);
  tool_.stats().phase("build");
  const Tracer tracer(frame, static_tree_), static_tracer(static_frame, static_tree_);
  const Lights lights(frame, emission), static_lights(static_frame, emission);

  PhotonOptions photon_options;
  photon_options.seed = paths.header.seed;
  photon_options.photon_count = paths.header.emitted_count;
  photon_options.group_count = paths.header.group_count;
  photon_options.set_kinds(paths.header.kinds);
  formats::PhotonHeader header = header_of(frame, emission, frame_number);
  header.map = "dynamic";

  tool_.stats().phase("trace", true);
  const PhotonTracer whole(tracer, lights, photon_options), without(static_tracer, static_lights, photon_options);
  const PhotonMapResult result =
      write_dynamic_map(without, whole, touched, header, output.sink(), tool_.progress_sink());
  tool_.stats().phase("commit");
  finish(&output, result, tracer.refused_ray_count() + static_tracer.refused_ray_count());
  tool_.stats().count("touched_paths", double(touched.size()));
}

}  // namespace tempolux::tools
