#include "tools/stages/build_records.h"

#include <algorithm>
#include <optional>
#include <span>
#include <utility>

#include "formats/error.h"
#include "lib/gather/cache_files.h"
#include "lib/render/camera_records.h"
#include "lib/scene/static_scene.h"

namespace tempolux::tools {
namespace {

/// Header of a cache that is placed for these frames.
formats::IrradcacheHeader cache_header(const CacheOptions& options, const SceneFrame& frame,
                                       const std::vector<int>& frames, std::span<const IrradianceRecord> records,
                                       float least_cosine) {
  formats::IrradcacheHeader header = records_header(frame, records, least_cosine, options.gather, options.placement);
  header.identity.first_frame = *std::min_element(frames.begin(), frames.end());
  header.identity.last_frame = *std::max_element(frames.begin(), frames.end());
  header.columns |= formats::column_noise;
  std::vector<int> sorted = frames;
  std::sort(sorted.begin(), sorted.end());
  for (int f : sorted) {
    if (!header.placed_frames.empty() && header.placed_frames.back()[1] >= f - 1) header.placed_frames.back()[1] = f;
    else header.placed_frames.push_back({f, f});
  }
  return header;
}

/// Throws InputError unless two frames differ only in their cameras.
void check_lit_alike(const CacheOptions& options, const SceneFrame& frame, const SceneFrame& first) {
  if (!formats::stale_concerns(identity_of(frame), identity_of(first)).empty())
    throw InputError(options.scene() + ": frame " + std::to_string(frame.frame) +
                     " is lit or built differently from frame " + std::to_string(first.frame) +
                     ": one cache cannot hold for both; make one for each");
}

/// The cameras for which records are placed. `at` returns the scene at a frame, or the static scene of the frame.
/// `first`: the result of `at` for the first frame.
RecordCameras cameras_of(Tool& tool, SceneInput& input, const CacheOptions& options, const std::vector<int>& frames,
                         const SceneFrame& first, std::function<SceneFrame(int)> at) {
  RecordCameras cameras{frames, input.scene().camera_node(tool.common().camera), options.width, options.height, {}, {}};
  cameras.at = [&options, &first, at = std::move(at)](int number) {
    SceneFrame frame = at(number);
    check_lit_alike(options, frame, first);
    return frame;
  };
  cameras.progress = tool.progress_sink();
  return cameras;
}

void count(Tool& tool, std::size_t records, const GatherCounts& counts) {
  tool.stats().count("records", double(records));
  tool.stats().count("gather_rays", double(counts.rays));
  tool.stats().count("near_hits", double(counts.near_hits));
  tool.stats().count("points_read", double(counts.points_read));
  tool.stats().count("shadow_rays", double(counts.shadow_rays));
  tool.stats().count("unanswered", double(counts.unanswered));
}

/// Points made from photons, or read from a file, or read as two parts.
DividedGatherPoints gather_points(Tool& tool, const CacheOptions& options, const Tracer& tracer, const Lights& lights) {
  if (!options.points.empty()) return read_divided_points(tool, options.points, options.high, tracer.frame());
  if (!options.high.empty()) return points_of_parts(tool, options, tracer, lights);
  return {points_of_photons(tool, options.photons, tracer, lights, options.points_of(tracer.frame())), {}};
}

/// The dynamic maps of options.dynamic as densities over the static scene; the frame's own map comes first.
std::vector<SignedDensity> read_changes(Tool& tool, const CacheOptions& options, const Tracer& static_scene,
                                        const SceneFrame& frame) {
  std::vector<SignedDensity> maps;
  const DensityOptions density{options.point.neighbours, options.point.max_radius, kChangeProbes};
  for (const std::string& name : options.dynamic) {
    const std::string file = frame_name(name, frame.frame);
    const bool own = maps.empty();
    const formats::PhotonMap map =
        own ? read_photons(tool, file, frame, {.map = "dynamic"}) : read_earlier_change(tool, file, frame);
    maps.emplace_back(static_scene, map.photons, density, shift_of(map.header.origin, frame));
  }
  return maps;
}

}  // namespace

void build_records(Tool& tool, SceneInput& input, CacheOptions options, const std::vector<int>& frames) {
  Output output(options.output);
  tool.stats().phase("evaluate");
  const bool is_static = options.map == "static";
  const auto state = [&](int number) { return is_static ? static_scene_of(input.at(number)) : input.at(number); };
  const SceneFrame first = state(frames.front());
  tool.stats().phase("build");
  const Tracer tracer(first);
  const Lights lights(first, input.emission(first.frame));
  if (!options.points.empty()) tool.stats().phase("read points");
  const DividedGatherPoints divided = gather_points(tool, options, tracer, lights);
  const GatherPoints& points = divided.whole;
  tool.stats().phase("prepare records");
  if (!options.keep_points.empty()) {
    Output keep(options.keep_points);
    write_points(tool, points, first, keep);
  }
  const PointsRead read(tool, tracer, lights, divided, options.gather);
  const Lights guided = guided_lights(tracer, lights, points.points);
  // Light of lamps close to surfaces is left to pixels, but not in static records: these are later updated by dynamic
  // photons, which do not leave out such light.
  options.gather.lamps_apart = !is_static && !read.beside_lamps.empty();
  const FinalGather gather(tracer, guided, read.lookup, options.gather);
  RecordStore store;

  tool.stats().phase("records", true);
  const GatherCounts counts = place_for_cameras(gather, tracer, cameras_of(tool, input, options, frames, first, state),
                                                options.placement, store);
  tool.stats().phase("write");
  formats::IrradcacheHeader header = cache_header(options, first, frames, store.records(), store.least_cosine());
  if (options.gather.lamps_apart) header.lamps_apart = double(kBesideLamp * points.spacing);
  if (is_static) header.identity.first_frame = first.segment.first, header.identity.last_frame = first.segment.last;
  header.history = points.history + tool.history_line();
  write_records(header, to_file(store.records(), first), output);
  tool.stats().end_phase();
  count(tool, store.records().size(), counts);
}

void build_updated_records(Tool& tool, SceneInput& input, const CacheOptions& options, const std::vector<int>& frames,
                           StaticTree& tree) {
  const int number = frames.front();
  Output output(frame_name(options.output, number));
  tool.stats().phase("evaluate");
  const SceneFrame frame = input.at(number), static_frame = static_scene_of(frame);
  tool.stats().phase("build");
  const Tracer tracer(frame, tree), without(static_frame, tree);
  const Lights lights(frame, input.emission(frame.frame));
  tool.stats().phase("read points");
  const DividedGatherPoints whole{read_points(tool, frame_name(options.points, number), frame), {}};
  const GatherPoints& points = whole.whole;
  tool.stats().phase("read photons");
  const std::vector<SignedDensity> maps = read_changes(tool, options, without, frame);
  tool.stats().phase("prepare records");
  const std::string name = frame_name(options.update, number);
  tool.depends_on(name);
  const formats::IrradcacheFile file = formats::load_irradcache(name);
  if (file.header.lamps_apart > 0)
    throw InputError(name +
                     ": its records leave out light of lamps close to surfaces; give a file made with --map static");
  RecordStore fixed(float(file.header.least_cosine));
  LocalisedRecords cache;
  cache.history = add_records(tool, name, file, static_frame, fixed) + points.history;
  cache.standing.assign(fixed.records().begin(), fixed.records().end());
  GatherOptions gathering = options.gather;
  const PointsRead read(tool, tracer, lights, whole, gathering);
  const Lights guided = guided_lights(tracer, lights, points.points);
  const FinalGather gather(tracer, guided, read.lookup, gathering);

  tool.stats().phase("records", true);
  const RecordCameras cameras = cameras_of(tool, input, options, frames, frame, [&](int f) { return input.at(f); });
  const GatherCounts counts = update_for_cameras({gather, tracer, read.lookup, maps, {}, options.gather.seed}, cameras,
                                                 options.placement, cache);

  tool.stats().phase("write");
  std::vector<IrradianceRecord> all = cache.standing;
  all.insert(all.end(), cache.gathered.begin(), cache.gathered.end());
  formats::IrradcacheHeader header =
      cache_header(options, frame, frames, all, std::max(cache.least_cosine, fixed.least_cosine()));
  header.columns |= formats::column_influence | formats::column_update;
  header.history = cache.history + (frames.size() == 1 ? tool.history_line(number) : tool.history_line());
  write_records(header, to_file(cache, frame), output);
  tool.stats().end_phase();
  count(tool, cache.gathered.size(), counts);
  tool.stats().count("records_updated", double(cache.standing.size()));
}

}  // namespace tempolux::tools
