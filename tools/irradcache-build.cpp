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
#include <CLI/CLI.hpp>
#include <algorithm>
#include <string>
#include <vector>

#include "formats/error.h"
#include "lib/gather/cache_files.h"
#include "lib/image/images_by_module.h"
#include "lib/render/known_light.h"
#include "lib/scene/standing.h"
#include "tools/common/gather_input.h"
#include "tools/common/localised_cache.h"
#include "tools/common/option_words.h"
#include "tools/common/tool_main.h"

using namespace tempolux;

namespace {

constexpr std::uint64_t kMaxPoints = 1 << 28;   ///< per side of all surfaces

struct Options {
  std::vector<std::string> inputs;  // [points|records] SCENE
  std::string photons, points, records, mask, output, keep_points, radii = "ward", map = "global", update;
  std::vector<std::string> dynamic;   // the frame's own first
  std::uint64_t point_count = PointOptions{}.count;
  int width = 640, height = 360;
  PointOptions point;
  GatherOptions gather;
  PlacementOptions placement;
  InfluenceThresholds influence;
  bool free_radii = false;

  std::string mode() const { return inputs.size() == 2 ? inputs[0] : "both"; }
  const std::string& scene() const { return inputs.back(); }
};

/// Points from a file of photons, in two phases: only the second works with all threads.
tools::GatherPoints points_of_photons(tools::Tool& tool, const std::string& file, const Tracer& tracer,
                                      const Lights& lights, const PointOptions& options) {
  tool.stats().phase("read photons");
  const formats::PhotonMap map = tools::read_photons(tool, file, tracer.frame(), tools::LightNeeded::all);
  tool.stats().phase("points", true);
  return tools::make_points(tool, map, tracer, lights, options);
}

/// Points of what stands, once for a segment, from its static map.
void build_standing_points(tools::Tool& tool, tools::SceneInput& input, const Options& options, int number) {
  tools::Output output(tools::frame_name(options.output, number), tool.common().no_clobber);
  tool.stats().phase("evaluate");
  const SceneFrame frame = standing_scene(input.at(number));
  tool.stats().phase("build");
  const Tracer tracer(frame);
  const Lights lights(frame, input.emission(frame.frame));
  tool.stats().phase("read photons");
  const formats::PhotonMap map = tools::read_photons(tool, tools::frame_name(options.photons, number), frame,
                                                     tools::LightNeeded::all, "static");
  tool.stats().phase("points", true);
  const tools::GatherPoints points = tools::make_points(tool, map, tracer, lights, options.point);
  tool.stats().phase("write");
  tools::write_points(tool, points, frame, output, std::array{frame.segment.first, frame.segment.last});
}

/// Points of a frame from those of what stands: what movers change is added, and their own points.
void build_updated_points(tools::Tool& tool, tools::SceneInput& input, const Options& options, int number,
                          StandingTree& tree) {
  tools::Output output(tools::frame_name(options.output, number), tool.common().no_clobber);
  tool.stats().phase("evaluate");
  const SceneFrame frame = input.at(number), standing = standing_scene(frame);
  const EmissionTable& emission = input.emission(frame.frame);
  tool.stats().phase("build");
  const Tracer whole(frame, tree), without(standing, tree);
  const Lights lights(frame, emission);
  tool.stats().phase("read points");
  tools::GatherPoints points = tools::read_points(tool, tools::frame_name(options.update, number), standing);
  tool.stats().phase("read photons");
  const formats::PhotonMap moved = tools::read_photons(tool, tools::frame_name(options.dynamic.front(), number), frame,
                                                       tools::LightNeeded::all, "dynamic");
  const formats::PhotonMap fixed =
      tools::read_photons(tool, tools::frame_name(options.photons, number), standing, tools::LightNeeded::all, "static",
                          static_photons_read(frame, options.point, points.points, moved.photons));
  if (moved.header.emitted_count != fixed.header.emitted_count || moved.header.group_count != fixed.header.group_count)
    throw InputError(options.dynamic.front() + ": of " + std::to_string(moved.header.emitted_count) + " paths, and the static map of " +
                     std::to_string(fixed.header.emitted_count) + "; trace it with the .paths file of that map");
  tool.stats().phase("points", true);
  PointUpdateCounts counts;
  tools::update_points(tool, fixed, moved, whole, without, lights, options.point, points, counts);
  tool.stats().phase("write");
  points.history = points.history + moved.header.history;
  tools::write_points(tool, points, frame, output);
  tool.stats().count("direct_sampled", double(counts.direct));
  tool.stats().count("points_changed", double(counts.changed));
  tool.stats().count("points_anew", double(counts.anew));
}

void build_points(tools::Tool& tool, tools::SceneInput& input, const Options& options, int number,
                  StandingTree& standing) {
  tools::Output output(tools::frame_name(options.output, number), tool.common().no_clobber);
  tool.stats().phase("evaluate");
  const SceneFrame frame = input.at(number);
  tool.stats().phase("build");
  const Tracer tracer(frame, standing);
  Lights lights(frame, input.emission(frame.frame));
  lights.weigh_sky_by_cosine();
  const tools::GatherPoints points =
      points_of_photons(tool, tools::frame_name(options.photons, number), tracer, lights, options.point);
  tool.stats().phase("write");
  tools::write_points(tool, points, frame, output);
}

/// Header of a cache placed for these frames.
formats::IrradcacheHeader cache_header(const Options& options, const SceneFrame& frame, const std::vector<int>& frames,
                                       std::span<const IrradianceRecord> records, float least_cosine) {
  formats::IrradcacheHeader header;
  header.identity = tools::identity_of(frame);
  header.identity.first_frame = *std::min_element(frames.begin(), frames.end());
  header.identity.last_frame = *std::max_element(frames.begin(), frames.end());
  header.origin = {frame.origin.x, frame.origin.y, frame.origin.z};
  header.columns = formats::column_clearance;
  header.rays = std::uint32_t(options.gather.rays);
  header.error_bound = double(options.placement.error_bound);
  header.least_cosine = double(least_cosine);
  for (const IrradianceRecord& record : records) {
    header.min_radius =
        header.max_radius > 0 ? std::min(header.min_radius, double(record.radius)) : double(record.radius);
    header.max_radius = std::max(header.max_radius, double(record.radius));
  }
  std::vector<int> sorted = frames;
  std::sort(sorted.begin(), sorted.end());
  for (int f : sorted) {
    if (!header.placed_frames.empty() && header.placed_frames.back()[1] >= f - 1) header.placed_frames.back()[1] = f;
    else header.placed_frames.push_back({f, f});
  }
  return header;
}

/// Of min_weight: what covers a pixel once there are records for another frame's camera. All frames are interpolated
/// from what the first was worth; a stricter first keeps the others from adding a few everywhere.
constexpr float kLaterWeight = 0.5f;

/// By pixel of the frame, 0: nobody looks there; empty without --mask.
std::vector<std::uint8_t> wanted_pixels(tools::Tool& tool, const Options& options, int number) {
  if (options.mask.empty()) return {};
  const std::string name = tools::frame_name(options.mask, number);
  tool.depends_on(name);
  MaskPixels mask = mask_by_module(name, 512ull << 20);
  if (mask.width != options.width || mask.height != options.height)
    throw InputError(name + ": " + std::to_string(mask.width) + "x" + std::to_string(mask.height) +
                     " pixels; a mask has the size of the picture, --size");
  return std::move(mask.pixels);
}

/// InputError unless all but the cameras is the same at two frames.
void check_lit_alike(const Options& options, const SceneFrame& frame, const SceneFrame& first) {
  if (!formats::stale_concerns(tools::identity_of(frame), tools::identity_of(first)).empty())
    throw InputError(options.scene() + ": frame " + std::to_string(frame.frame) + " is lit or built differently from frame " +
                     std::to_string(first.frame) + ": one cache cannot hold for both; make one for each");
}

/// Records for the cameras of all frames: one cache, valid while nothing but the camera changes.
void build_records(tools::Tool& tool, tools::SceneInput& input, Options options, const std::vector<int>& frames) {
  tools::Output output(options.output, tool.common().no_clobber);
  tool.stats().phase("evaluate");
  const bool standing = options.map == "static";
  const auto state = [&](int number) { return standing ? standing_scene(input.at(number)) : input.at(number); };
  const SceneFrame first = state(frames.front());
  tool.stats().phase("build");
  const Tracer tracer(first);
  const Lights lights(first, input.emission(first.frame));
  if (!options.points.empty()) tool.stats().phase("read points");
  const tools::GatherPoints points = options.points.empty()
                                         ? points_of_photons(tool, options.photons, tracer, lights, options.point)
                                         : tools::read_points(tool, options.points, first);
  tool.stats().phase("prepare records");
  if (!options.keep_points.empty()) {
    tools::Output keep(options.keep_points, tool.common().no_clobber);
    tools::write_points(tool, points, first, keep);
  }
  const PointLookup lookup(points.points, points.spacing, point_clearance(tracer));
  const FinalGather gather(tracer, lights, lookup, options.gather);
  RecordStore store({.least_cosine = least_cosine_of(options.placement.error_bound)});
  std::string history = points.history;
  if (!options.records.empty())
    history = tools::read_records(tool, options.records, tools::InputRole::replaceable, first, store);

  tool.stats().phase("records", true);
  GatherCounts counts;
  const int camera = input.scene().camera_node(tool.common().camera);
  for (int number : frames) {
    const SceneFrame frame = state(number);
    check_lit_alike(options, frame, first);
    const CameraView view(frame.camera(camera), frame.origin, options.width, options.height);
    PlacementOptions placement = options.placement;
    if (number != frames.front()) placement.min_weight *= kLaterWeight;
    const std::vector<std::uint8_t> wanted = wanted_pixels(tool, options, number);
    const PixelViews views = [&](std::span<const Look> looks, std::span<std::optional<SeenPoint>> seen) {
      seen_through(tracer, view, looks, seen);
      for (std::size_t i = 0; i < looks.size() && !wanted.empty(); ++i)
        if (!wanted[std::size_t(looks[i].y) * std::size_t(options.width) + std::size_t(looks[i].x)]) seen[i].reset();
    };
    const std::size_t added = place_records(gather, views, options.width, options.height, placement,
                                            store, counts, [&](double done) { tool.progress(done); });
    tool.stats().set("records_added." + std::to_string(number), double(added));
  }
  tool.stats().phase("write");
  formats::IrradcacheHeader header = cache_header(options, first, frames, store.records(), store.least_cosine());
  if (standing) header.identity.first_frame = first.segment.first, header.identity.last_frame = first.segment.last;
  header.history = history + tool.history_line();
  formats::IrradcacheWriter writer([&](const void* data, std::size_t size) { output.write(data, size); }, header);
  writer.write(to_file(store.records(), first));
  writer.finish();
  output.commit();
  tool.stats().end_phase();
  tool.stats().count("records", double(store.records().size()));
  tool.stats().count("gather_rays", double(counts.rays));
  tool.stats().count("near_hits", double(counts.near_hits));
  tool.stats().count("points_read", double(counts.points_read));
  tool.stats().count("unanswered", double(counts.unanswered));
}

/// Dynamic maps of a frame, its own first, as densities over the standing scene.
std::vector<SignedDensity> read_changes(tools::Tool& tool, const Options& options, const Tracer& standing, const SceneFrame& frame) {
  std::vector<SignedDensity> maps;
  const DensityOptions density{options.point.neighbours, options.point.max_radius, kChangeProbes};
  for (const std::string& name : options.dynamic) {
    const std::string file = tools::frame_name(name, frame.frame);
    const bool own = maps.empty();
    const formats::PhotonMap map = own ? tools::read_photons(tool, file, frame, tools::LightNeeded::all, "dynamic")
                                       : tools::read_earlier_change(tool, file, frame);
    const std::array<double, 3>& origin = map.header.origin;
    maps.emplace_back(standing, map.photons, density, Vec3d{origin[0], origin[1], origin[2]} - frame.origin);
  }
  return maps;
}

/// Records of a frame by localised gathering: those of what stands, updated, and new ones where movers matter to the cameras of
/// `frames`, which are lit alike.
void build_updated_records(tools::Tool& tool, tools::SceneInput& input, const Options& options, const std::vector<int>& frames,
                           StandingTree& tree) {
  const int number = frames.front();
  tools::Output output(tools::frame_name(options.output, number), tool.common().no_clobber);
  tool.stats().phase("evaluate");
  const SceneFrame frame = input.at(number), standing = standing_scene(frame);
  tool.stats().phase("build");
  const Tracer tracer(frame, tree), without(standing, tree);
  const Lights lights(frame, input.emission(frame.frame));
  tool.stats().phase("read points");
  const tools::GatherPoints points = tools::read_points(tool, tools::frame_name(options.points, number), frame);
  tool.stats().phase("read photons");
  const std::vector<SignedDensity> maps = read_changes(tool, options, without, frame);
  tool.stats().phase("prepare records");
  const std::string name = tools::frame_name(options.update, number);
  tool.depends_on(name);
  const formats::IrradcacheFile file = formats::load_irradcache(name);
  RecordStore fixed({.least_cosine = 0, .only_read = true});
  tools::LocalisedRecords cache;
  cache.history = tools::add_records(tool, name, file, standing, fixed) + points.history;
  cache.standing.assign(fixed.records().begin(), fixed.records().end());
  const PointLookup lookup(points.points, points.spacing, point_clearance(tracer));
  const FinalGather gather(tracer, lights, lookup, options.gather);

  tool.stats().phase("records", true);
  cache.changes = record_changes(cache.standing, maps, lookup, options.gather.seed);
  std::vector<float> influences;
  for (const RecordChange& change : cache.changes) influences.push_back(change.influence);
  const InfluenceField field(cache.standing, influences, options.influence);
  const std::vector<bool> moves = tools::moving_objects(frame);
  GatherCounts counts;
  RecordStore store({.least_cosine = least_cosine_of(options.placement.error_bound)});
  const int camera = input.scene().camera_node(tool.common().camera);
  for (const int f : frames) {
    const SceneFrame other = f == number ? frame : input.at(f);
    check_lit_alike(options, other, frame);
    const CameraView view(other.camera(camera), other.origin, options.width, options.height);
    const PixelViews views = [&](std::span<const Look> looks, std::span<std::optional<SeenPoint>> seen) {
      seen_through(tracer, view, looks, seen);
      for (std::optional<SeenPoint>& point : seen.first(looks.size())) {
        if (!point || (point->surface.object < moves.size() && moves[point->surface.object])) continue;
        if (!(field.at(point->surface.position, point->normal) > options.influence.low)) point.reset();
      }
    };
    PlacementOptions placement = options.placement;
    if (f != number) placement.min_weight *= kLaterWeight;
    const std::size_t added = place_records(gather, views, options.width, options.height, placement, store, counts,
                                            [&](double done) { tool.progress(done); });
    tool.stats().set("records_added." + std::to_string(f), double(added));
  }
  cache.gathered.assign(store.records().begin(), store.records().end());

  tool.stats().phase("write");
  std::vector<IrradianceRecord> all = cache.standing;
  all.insert(all.end(), cache.gathered.begin(), cache.gathered.end());
  formats::IrradcacheHeader header =
      cache_header(options, frame, frames, all, std::max(store.least_cosine(), fixed.least_cosine()));
  header.columns |= formats::column_influence | formats::column_update;
  header.history = cache.history + (frames.size() == 1 ? tool.history_line(number) : tool.history_line());
  formats::IrradcacheWriter writer([&](const void* data, std::size_t size) { output.write(data, size); }, header);
  writer.write(tools::to_file(cache, frame));
  writer.finish();
  output.commit();
  tool.stats().end_phase();
  tool.stats().count("records", double(cache.gathered.size()));
  tool.stats().count("records_updated", double(cache.standing.size()));
  tool.stats().count("gather_rays", double(counts.rays));
  tool.stats().count("near_hits", double(counts.near_hits));
  tool.stats().count("points_read", double(counts.points_read));
  tool.stats().count("unanswered", double(counts.unanswered));
}

/// Options that a step does not read, given all the same, would do nothing without a word.
void refuse_unread(const CLI::App& app, const std::string& step, const std::vector<std::string>& names) {
  for (const std::string& name : names)
    if (app.get_option(name)->count() > 0) throw InputError(name + ": " + step + " does not read it; leave it out");
}

void check(const CLI::App& app, const Options& options, const std::vector<int>& frames) {
  const std::string mode = options.mode();
  if (mode != "both" && mode != "points" && mode != "records")
    throw InputError("'" + options.inputs[0] + "' is not a step: it is points, records, or nothing for both");
  if (mode == "points" && options.photons.empty()) throw InputError("points: name the photon map with --photons FILE");
  if (mode == "records" && options.points.empty()) throw InputError("records: name the points with --points FILE");
  if (mode == "both" && options.photons.empty() == options.points.empty())
    throw InputError("name either the photon map, --photons FILE, or the points made from it, --points FILE");
  if (mode == "both") refuse_unread(app, "a run without a step", {"--map", "--update", "--dynamic"});
  if (mode == "records" && !options.update.empty()) refuse_unread(app, "records --update", {"--records"});
  if (mode == "points" && options.dynamic.size() > 1) throw InputError("--dynamic: points take one map, that of their frame");
  tools::check_influence(options.influence);
  if (options.update.empty() != options.dynamic.empty())
    throw InputError("--update and --dynamic go together: points of what stands, and what movers change");
  if (!options.update.empty() && options.map == "static")
    throw InputError("--update: makes points of the whole scene; leave out --map static");
  if (mode == "points")
    refuse_unread(app, "points", {"--influence-low", "--influence-high", "--influence-absolute", "--points", "--records", "--rays", "--error-bound", "--radii", "--free-radii",
                                  "--min-radius-px", "--min-weight", "--size", "--mask", "--keep-points"});
  else if (!options.points.empty())
    refuse_unread(app, "a run with --points",
                  {"--photons", "--point-count", "--neighbours", "--light-samples", "--keep-points"});
  if (options.point_count < 1 || options.point_count > kMaxPoints)
    throw InputError("--point-count: " + std::to_string(options.point_count) + " is not from 1 to " +
                     std::to_string(kMaxPoints));
  if (mode == "points" && frames.size() > 1 && !tools::has_frame_pattern(options.output))
    throw InputError("--output: several frames need a pattern, for example f.####.irradpoints");
}

void add_options(tools::Tool& tool, Options& options) {
  CLI::App& app = tool.app();
  app.add_option("scene", options.inputs, "glTF 2.0 scene, after the word points or records if only that is wanted")
      ->required()->expected(1, 2)->type_name("[points|records] SCENE");
  app.add_option("--photons", options.photons, ".photons file of this frame with caustic and indirect light")
      ->type_name("FILE");
  app.add_option("--points", options.points, ".irradpoints file of this frame, instead of --photons")
      ->type_name("FILE");
  app.add_option("--records", options.records, ".irradcache file to extend: its records are kept")->type_name("FILE");
  tool.count_option("--point-count", options.point_count, "irradiance points per side of all surfaces that stand; what moves gets as many per area");
  app.add_option("--map", options.map,
                 "global, or static: points and records of the scene without what moves in the frame's segment, from its static "
                 "map and points")
      ->capture_default_str()->check(CLI::IsMember({"global", "static"}));
  app.add_option("--update", options.update,
                 "file of --map static: .irradpoints, from which with --photons (that static map) and --dynamic points of this "
                 "frame follow; .irradcache, from which with --points and --dynamic records of this frame follow")
      ->type_name("FILE");
  app.add_option("--dynamic", options.dynamic,
                 "of --update: .photons file of this frame, photon-trace --map dynamic; records take those of the frames before "
                 "after it, where they mattered records are made anew, too")
      ->type_name("FILE...");
  tools::influence_options(tool, options.influence);
  app.add_option("--neighbours", options.point.neighbours, "photons per density estimate")
      ->capture_default_str()->check(tools::number_between(2, kMaxNeighbours));
  app.add_option("--light-samples", options.point.light_samples, "shadow rays per point for direct light")
      ->capture_default_str()->check(tools::number_between(1, 4096));
  app.add_option("--rays", options.gather.rays,
                 "gather rays per record; parts of its hemisphere where light is uneven get up to 9 times as many, all "
                 "of it up "
                 "to 8 times where light comes from a small share of it")
      ->capture_default_str()
      ->check(tools::number_between(1, 1 << 20));
  app.add_option("--error-bound", options.placement.error_bound,
                 "radius of a record / harmonic mean distance to what it sees: smaller is finer; records count where normals "
                 "differ by less than 50 degrees times this, from 5 to 20")
      ->capture_default_str()->check(tools::number_between(1e-3, 2.0));
  app.add_option(
         "--radii", options.radii,
         "what the radius of a record follows from: ward (distances of what it sees) or hessian (second derivatives)")
      ->capture_default_str()
      ->check(CLI::IsMember({"ward", "hessian"}));
  app.add_flag(
      "--free-radii", options.free_radii,
      "leave radii as each record's own rays tell; else none exceeds a neighbour's by more than the error bound x "
      "their distance: what is small is missed by many");
  app.add_option("--min-radius-px", options.placement.min_radius_px, "smallest radius of a record, pixels")
      ->capture_default_str()->check(tools::number_above(0));
  app.add_option("--min-weight", options.placement.min_weight, "sum of records' weights at which a pixel is covered")
      ->capture_default_str()->check(tools::number_between(1e-6, 0.99));
  app.add_option("--mask", options.mask,
                 "EXR file, or a pattern: records only where pixels look at which a channel is not 0, as of ibr-warp")
      ->type_name("FILE");
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
    check(tool.app(), options, frames);
    options.point.count = std::uint32_t(options.point_count);
    options.placement.clamp_neighbours = !options.free_radii;
    options.gather.curvature = options.placement.by_curvature = options.radii == "hessian";
    options.point.seed = options.gather.seed = tool.common().seed_for_frame(frames.front());
    tool.stats().phase("load");
    const unsigned camera = options.mode() == "points" ? tools::SceneInput::nothing : tools::SceneInput::a_camera;
    tools::SceneInput input(tool, options.scene(), tools::SceneInput::light | camera);
    StandingTree standing;
    if (options.mode() == "points")
      for (int frame : frames)
        if (options.map == "static") build_standing_points(tool, input, options, frame);
        else if (!options.update.empty()) build_updated_points(tool, input, options, frame, standing);
        else build_points(tool, input, options, frame, standing);
    else if (!options.update.empty() && !tools::has_frame_pattern(options.output))
      build_updated_records(tool, input, options, frames, standing);
    else if (!options.update.empty())
      for (int frame : frames) build_updated_records(tool, input, options, {frame}, standing);
    else
      build_records(tool, input, options, frames);
    return tools::exit_ok;
  });
}
