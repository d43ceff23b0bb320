// gather-temporal -- light over time: irradiance records that keep their incoming light from frame to frame, and
// light textures from the photons of many frames.
//
//     gather-temporal density room.glb --frames 0-47 --photons p.####.photons -o d.####.meshirrad
//     gather-temporal final room.glb --frame 0 --points p.0000.irradpoints --size 960x540
//                     -o s.0000.radsamples --cache c.0000.irradcache
//     gather-temporal final room.glb --frame 1 --points p.0001.irradpoints --size 960x540
//                     --previous s.0000.radsamples -o s.0001.radsamples --cache c.0001.irradcache
//     gather-temporal final room.glb --frames 0-47 --points p.####.irradpoints --size 960x540
//                     -o s.####.radsamples --cache c.####.irradcache
//
// Formats: formats/radsamples/radsamples.md, formats/irradcache/irradcache.md.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <string>
#include <vector>

#include "formats/base_file.h"
#include "formats/error.h"
#include "lib/gather/bright_points.h"
#include "lib/gather/cache_files.h"
#include "lib/render/known_light.h"
#include "lib/temporal/kept_files.h"
#include "lib/temporal/temporal_gather.h"
#include "tools/common/option_words.h"
#include "tools/stages/photon_windows.h"
#include "tools/common/tool_main.h"
#include "tools/stages/gather_input.h"

using namespace tempolux;

namespace {

struct Options {
  std::vector<std::string> inputs;  // final SCENE
  std::string points, high, previous, output, cache;
  int width = 640, height = 360;
  GatherOptions gather;
  PlacementOptions placement;
  TemporalOptions temporal;

  const std::string& scene() const { return inputs.back(); }
};

/// The previous frame, kept in memory: its records, and its scene.
struct Chain {
  KeptHemispheres kept;
  std::optional<SceneFrame> before;  ///< empty: nothing is kept
  std::string places_hash;           ///< of the points that anchors name
  KeptFiles files;

  void follow(SceneFrame frame, const FramePoints& points) {
    before.emplace(std::move(frame));
    places_hash = points.places_hash;
  }
};

/// Anchors are numbers of points, so each point must lie where the previous frame's point of that number lay.
void check_points(const Chain& chain, const std::string& file, const FramePoints& points) {
  if (!chain.before || chain.places_hash.empty() || chain.places_hash == points.places_hash) return;
  throw InputError(file + ": its " + std::to_string(points.anchored) +
                   " points on static surfaces lie elsewhere than those of frame " +
                   std::to_string(chain.before->frame) +
                   " before it; make the points of all frames of a segment with the same options");
}

void write_cache(const Options& options, const SceneFrame& frame, const RecordStore& store, const std::string& history,
                 tools::Output& output) {
  formats::IrradcacheHeader header =
      tools::records_header(frame, store.records(), store.least_cosine(), options.gather, options.placement);
  header.placed_frames = {{frame.frame, frame.frame}};
  header.history = history;
  tools::write_records(header, to_file(store.records(), frame), output);
}

void count(tools::Tool& tool, const TemporalCounts& counts, int frame, bool first) {
  const auto set = [&](const char* name, std::uint64_t value) {
    tool.stats().set(std::string(name) + "." + std::to_string(frame), double(value));
    tool.stats().count(name, double(value));
  };
  set("records", counts.records);
  set("records_born", counts.born);
  set("records_removed", counts.removed + counts.deforming);
  set("records_unchanged", counts.kept);
  set("records_explicit_only", counts.explicit_only);
  set("cells", counts.cells);
  set("cells_moved", counts.moved);
  set("cells_lost", counts.lost);
  set("cells_unanchored", counts.unanchored);
  set("cells_near", counts.near);
  set("cells_aged", counts.aged);
  set("cells_scaled", counts.scaled);
  set("birth_rays", counts.birth.rays);
  set("update_rays", counts.update.rays);
  set("shadow_rays", counts.birth.shadow_rays + counts.update.shadow_rays);
  set("near_hits", counts.birth.near_hits + counts.update.near_hits);
  set("unanswered", counts.birth.unanswered + counts.update.unanswered);
  double cells = 0, ages = 0;
  for (std::size_t age = 0; age < counts.ages.size(); ++age)
    cells += double(counts.ages[age]), ages += double(age) * double(counts.ages[age]);
  if (cells > 0) tool.stats().set("mean_age." + std::to_string(frame), ages / cells);
  if (!first && counts.cells > 0)
    tool.stats().set(
        "retraced_share." + std::to_string(frame),
        double(counts.moved + counts.lost + counts.unanchored + counts.near + counts.aged) / double(counts.cells));
}

/// `high`: the high part, `file` then being the low part; "": `file` holds all light.
FramePoints read_frame_points(tools::Tool& tool, const std::string& file, const std::string& high,
                              const SceneFrame& frame) {
  if (high.empty()) return {{tools::read_points(tool, file, frame), {}}, frame};
  return {tools::read_divided_points(tool, file, high, frame), frame};
}

/// Reads what the previous frame has kept, and that frame's scene.
void read_previous(tools::Tool& tool, tools::SceneInput& input, const std::string& file, const SceneFrame& now,
                   const FramePoints& points, Chain& chain) {
  tool.depends_on(file, tools::InputRole::replaceable);
  const formats::RadsamplesHeader header = read_kept(file, now, chain.kept).header;
  if (!header.base_name.empty()) tool.depends_on(formats::path_of_base(file, header.base_name));
  check_kept(file, header, now, points, chain.kept);
  chain.before.emplace(input.at(header.identity.first_frame, false));
  tools::check_identity(tool, file, header.identity, *chain.before);
}

/// Gathers one frame from the previous one in `chain`, and stores it there.
void gather_frame(tools::Tool& tool, tools::SceneInput& input, const Options& options, int number, StaticTree& standing,
                  Chain& chain) {
  const bool single = !options.previous.empty();
  const std::string samples = tools::frame_name(options.output, number),
                    cache = tools::frame_name(options.cache, number);
  tool.stats().phase("evaluate");
  SceneFrame frame = input.at(number);
  tool.stats().phase("read points");
  FramePoints points = read_frame_points(tool, tools::frame_name(options.points, number),
                                         options.high.empty() ? "" : tools::frame_name(options.high, number), frame);
  const std::string history = points.read.history + tool.history_line(number);
  tools::Output kept_output(samples), cache_output(cache);
  if (single && !chain.before) {
    tool.stats().phase("read samples");
    chain.kept = {};
    read_previous(tool, input, options.previous, frame, points, chain);
  }
  if (chain.before && chain.before->segment.first != frame.segment.first) chain.before.reset();
  check_points(chain, tools::frame_name(options.points, number), points);
  if (!chain.before) chain.kept = {};
  tool.stats().phase("build");
  const Tracer tracer(frame, standing);
  const Lights lights(frame, input.emission(frame.frame));
  const PointLookup lookup(points.read.points, points.read.spacing, point_clearance(tracer));
  const CameraView view(frame.camera(input.scene().camera_node(tool.common().camera)), frame.origin, options.width,
                        options.height);
  const auto eye = [&](Vec3 place) -> std::optional<Vec3> {
    const auto at = view.project(place);
    if (!at) return std::nullopt;
    return view.ray(float((*at)[0]), float((*at)[1])).origin;
  };
  const TemporalScene scene{tracer,
                            lights,
                            lookup,
                            points.read.points,
                            points.anchored,
                            chain.before ? &*chain.before : nullptr,
                            points.high_shares,
                            points.high_hash,
                            eye};
  GatherOptions rays = options.gather;
  rays.seed = tool.common().seed_for_frame(number);
  std::optional<BrightPoints> bright;
  if (std::any_of(points.high_shares.begin(), points.high_shares.end(), [](float share) { return share > 0; })) {
    bright.emplace(tracer, lights, lookup, points.high_shares, BrightOptions{.seed = rays.seed});
    rays.bright = &*bright;
  }
  const TemporalGather gather(scene, rays, options.placement, options.temporal, sample_unit(frame));
  const PixelView seen = [&](const Look& look) { return seen_through(tracer, view, look); };
  tool.stats().phase("records", true);
  TemporalCounts counts;
  if (chain.before) gather.advance(chain.kept, counts);
  RecordStore store({.least_cosine = least_cosine_of(options.placement.error_bound)});
  gather.place(seen, options.width, options.height, chain.kept, store, counts,
               [&](double done) { tool.progress(done); });
  tool.stats().phase("write");
  write_cache(options, frame, store, history, cache_output);
  chain.files.write(chain.kept, frame, points, history, kept_output.is_stdout() ? "" : kept_output.path(),
                    kept_output.sink());
  kept_output.commit();
  tool.stats().end_phase();
  count(tool, counts, number, !chain.before);
  chain.follow(std::move(frame), points);
}

void check(const tools::Tool& tool, const Options& options) {
  const std::vector<int>& frames = tool.common().frames;
  if (options.inputs.size() != 2 || options.inputs[0] != "final")
    throw InputError("'" + options.inputs[0] + "' is not a way to gather over time: final, then the scene");
  if (frames.size() > 1) {
    if (!options.previous.empty())
      throw InputError("--previous: of one frame; with --frames each follows the one before");
    tool.check_patterns({options.output, options.cache, options.points, options.high});
    if (!std::is_sorted(frames.begin(), frames.end()))
      throw InputError("--frames: each frame follows the one before; name them upwards");
  }
}

void add_options(tools::Tool& tool, Options& options) {
  CLI::App& app = tool.app();
  app.add_option("scene", options.inputs, "final, and a glTF 2.0 scene")
      ->required()
      ->expected(1, 2)
      ->type_name("final SCENE");
  tool.file_option("--points", options.points, ".irradpoints file of the frame, or a pattern")->required();
  tool.file_option("--high", options.high,
                   "high part from photonmap-split, .irradpoints, or a pattern; --points is then the low part. Samples "
                   "hold the light that rays contribute; bright points are sampled explicitly in each frame");
  tool.leave_out_of_history(
      tool.file_option("--previous", options.previous,
                       ".radsamples file of an earlier frame of the same segment, from which this frame follows; "
                       "without it the frame is gathered anew"));
  tool.number_option(
      "--rays", options.gather.rays, 1, 1 << 20,
      "gather rays per record, one per cell; a record has up to 9 times as many cells where its neighbours "
      "found uneven light");
  tool.number_option(
      "--refresh", options.temporal.refresh, 0, 1,
      "share of the cells that are traced in a frame, in records whose light changed: first the cells that "
      "motion concerns, then cells drawn by age, at least a quarter of this share");
  tool.number_option("--error-bound", options.placement.error_bound, 1e-3, 2.0,
                     "radius of a record divided by the harmonic mean distance of the surfaces that it sees: smaller "
                     "values give more records");
  tool.size_option("--size", options.width, options.height, "picture for which records are placed, pixels");
  tool.output_option(options.cache, ".irradcache file, or a pattern: the records of the frame", "--cache")->required();
  tool.output_option(options.output, ".radsamples file, or a pattern: the samples from which the next frame follows")
      ->required();
}

}  // namespace

int main(int argc, char** argv) {
  if (argc > 1 && std::string_view(argv[1]) == "density") return tools::photon_windows(argc - 1, argv + 1);
  tools::Tool tool("gather-temporal",
                   "Gather indirect light in records that keep their incoming light from frame to frame.", argc, argv);
  Options options;
  add_options(tool, options);
  tool.common_options(tools::uses_scene | tools::uses_seed | tools::uses_camera | tools::uses_frames);

  return tool.run([&] {
    const std::vector<int>& frames = tool.common().frames;
    check(tool, options);
    tool.stats().phase("load");
    tools::SceneInput input(tool, options.scene(), tools::SceneInput::light | tools::SceneInput::a_camera);
    StaticTree standing;
    Chain chain;
    for (const int frame : frames) gather_frame(tool, input, options, frame, standing, chain);
    return tools::exit_ok;
  });
}
