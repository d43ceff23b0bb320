#include "tools/stages/gather_frames.h"

#include <algorithm>
#include <optional>

#include "formats/base_file.h"
#include "formats/error.h"
#include "lib/gather/cache_files.h"
#include "lib/render/known_light.h"
#include "lib/temporal/kept_files.h"
#include "tools/stages/gather_input.h"

namespace tempolux::tools {
namespace {

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

void write_cache(const TemporalGatherOptions& options, const SceneFrame& frame, const RecordStore& store,
                 const std::string& history, Output& output) {
  formats::IrradcacheHeader header =
      records_header(frame, store.records(), store.least_cosine(), options.gather, options.placement);
  header.placed_frames = {{frame.frame, frame.frame}};
  header.history = history;
  write_records(header, to_file(store.records(), frame), output);
}

void count(Tool& tool, const TemporalCounts& counts, int frame, bool first) {
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
FramePoints read_frame_points(Tool& tool, const std::string& file, const std::string& high, const SceneFrame& frame) {
  if (high.empty()) return {{read_points(tool, file, frame), {}}, frame};
  return {read_divided_points(tool, file, high, frame), frame};
}

/// Reads what the previous frame has kept, and that frame's scene.
void read_previous(Tool& tool, SceneInput& input, const std::string& file, const SceneFrame& now,
                   const FramePoints& points, Chain& chain) {
  tool.depends_on(file, InputRole::replaceable);
  const formats::RadsamplesHeader header = read_kept(file, now, chain.kept).header;
  if (!header.base_name.empty()) tool.depends_on(formats::path_of_base(file, header.base_name));
  check_kept(file, header, now, points, chain.kept);
  chain.before.emplace(input.at(header.identity.first_frame, false));
  check_identity(tool, file, header.identity, *chain.before);
}

/// Prepares the chain for a frame: reads the previous frame where it is a file, and forgets it in a new segment.
void continue_chain(Tool& tool, SceneInput& input, const TemporalGatherOptions& options, const SceneFrame& frame,
                    const FramePoints& points, Chain& chain) {
  if (!options.previous.empty() && !chain.before) {
    tool.stats().phase("read samples");
    chain.kept = {};
    read_previous(tool, input, options.previous, frame, points, chain);
  }
  if (chain.before && chain.before->segment.first != frame.segment.first) chain.before.reset();
  check_points(chain, options.points, points);
  if (!chain.before) chain.kept = {};
}

/// Direction towards the camera from a place that it sees, as TemporalScene::eye needs it.
std::optional<Vec3> eye_from(const CameraView& view, Vec3 place) {
  const auto at = view.project(place);
  if (!at) return std::nullopt;
  return view.ray(float((*at)[0]), float((*at)[1])).origin;
}

/// Gathers one frame from the previous one in `chain`, and stores it there.
void gather_frame(Tool& tool, SceneInput& input, TemporalGatherOptions options, int number, StaticTree& standing,
                  Chain& chain) {
  for (std::string* name : {&options.output, &options.cache, &options.points, &options.high})
    *name = frame_name(*name, number);
  tool.stats().phase("evaluate");
  SceneFrame frame = input.at(number);
  tool.stats().phase("read points");
  FramePoints points = read_frame_points(tool, options.points, options.high, frame);
  const std::string history = points.read.history + tool.history_line(number);
  Output kept_output(options.output), cache_output(options.cache);
  continue_chain(tool, input, options, frame, points, chain);
  tool.stats().phase("build");
  const Tracer tracer(frame, standing);
  const Lights lights(frame, input.emission(frame.frame));
  GatherOptions rays = options.gather;
  rays.seed = tool.common().seed_for_frame(number);
  const PointsRead read(tool, tracer, lights, points.read, points.high_shares, rays);
  const CameraView view(frame.camera(input.scene().camera_node(tool.common().camera)), frame.origin, options.width,
                        options.height);
  const TemporalScene scene{tracer,
                            lights,
                            read.lookup,
                            points.read.points,
                            points.anchored,
                            chain.before ? &*chain.before : nullptr,
                            points.high_shares,
                            points.high_hash,
                            [&](Vec3 place) { return eye_from(view, place); }};
  const TemporalGather gather(scene, rays, options.placement, options.temporal, sample_unit(frame));
  const PixelView seen = [&](const Look& look) { return seen_through(tracer, view, look); };
  tool.stats().phase("records", true);
  TemporalCounts counts;
  if (chain.before) gather.advance(chain.kept, counts);
  RecordStore store;
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

}  // namespace

void gather_frames(Tool& tool, SceneInput& input, const TemporalGatherOptions& options) {
  StaticTree standing;
  Chain chain;
  for (const int frame : tool.common().frames) gather_frame(tool, input, options, frame, standing, chain);
}

}  // namespace tempolux::tools
