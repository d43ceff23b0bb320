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

/// Gathers the frames of a run, each from the one before, which is kept in memory.
class GatherRun {
 public:
  GatherRun(Tool& tool, SceneInput& input, const TemporalGatherOptions& options)
      : tool_(tool), input_(input), options_(options) {}
  void gather(int number);

 private:
  void check_points(const std::string& file, const FramePoints& points) const;
  void read_previous(const SceneFrame& now, const FramePoints& points);
  void continue_chain(const SceneFrame& frame, const FramePoints& points);

  Tool& tool_;
  SceneInput& input_;
  const TemporalGatherOptions& options_;
  StaticTree tree_;
  KeptHemispheres kept_;              ///< records of the previous frame
  std::optional<SceneFrame> before_;  ///< the scene at the previous frame; empty: nothing is kept
  std::string places_hash_;           ///< of the points that anchors name
  KeptFiles files_;
};

/// Anchors are numbers of points, so each point must lie at the place of the previous frame's point of the same number.
void GatherRun::check_points(const std::string& file, const FramePoints& points) const {
  if (!before_ || places_hash_.empty() || places_hash_ == points.places_hash) return;
  throw InputError(file + ": its " + std::to_string(points.anchored) +
                   " points on static surfaces lie elsewhere than those of frame " + std::to_string(before_->frame) +
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

/// Reads the kept samples of the previous frame, and evaluates the scene at that frame.
void GatherRun::read_previous(const SceneFrame& now, const FramePoints& points) {
  const std::string& file = options_.previous;
  tool_.depends_on(file, InputRole::replaceable);
  const formats::RadsamplesHeader header = read_kept(file, now, kept_).header;
  if (!header.base_name.empty()) tool_.depends_on(formats::path_of_base(file, header.base_name));
  check_kept(file, header, now, points, kept_);
  before_.emplace(input_.at(header.identity.first_frame, false));
  check_identity(tool_, file, header.identity, *before_);
}

/// Prepares for a frame: reads the previous frame if it is a file, and drops it at the start of a segment.
void GatherRun::continue_chain(const SceneFrame& frame, const FramePoints& points) {
  if (!options_.previous.empty() && !before_) {
    tool_.stats().phase("read samples");
    kept_ = {};
    read_previous(frame, points);
  }
  if (before_ && before_->segment.first != frame.segment.first) before_.reset();
  check_points(frame_name(options_.points, frame.frame), points);
  if (!before_) kept_ = {};
}

/// The camera's position as seen from a place (TemporalScene::eye): the origin of the camera ray through the place.
/// Empty if the place is outside the picture.
std::optional<Vec3> eye_from(const CameraView& view, Vec3 place) {
  const auto at = view.project(place);
  if (!at) return std::nullopt;
  return view.pinhole({float((*at)[0]), float((*at)[1])}).origin;
}

/// Gathers one frame from the previous one, and keeps it for the next.
void GatherRun::gather(int number) {
  const auto named = [&](const std::string& pattern) { return frame_name(pattern, number); };
  tool_.stats().phase("evaluate");
  SceneFrame frame = input_.at(number);
  tool_.stats().phase("read points");
  const FramePoints points(read_divided_points(tool_, named(options_.points), named(options_.high), frame), frame);
  const std::string history = points.whole.history + tool_.history_line(number);
  Output kept_output(named(options_.output)), cache_output(named(options_.cache));
  continue_chain(frame, points);
  tool_.stats().phase("build");
  const Tracer tracer(frame, tree_);
  const Lights lights(frame, input_.emission(frame.frame));
  GatherOptions rays = options_.gather;
  rays.seed = tool_.common().seed_for_frame(number);
  const PointsRead read(tool_, tracer, lights, points, rays);
  const CameraView view(frame, input_.scene().camera_node(tool_.common().camera), options_.width, options_.height);
  const TemporalScene scene{tracer,
                            lights,
                            read.lookup,
                            points.whole.points,
                            points.anchored,
                            before_ ? &*before_ : nullptr,
                            points.high_shares,
                            points.high_hash,
                            [&](Vec3 place) { return eye_from(view, place); }};
  const TemporalGather gather(scene, rays, options_.placement, options_.temporal, sample_unit(frame));
  tool_.stats().phase("records", true);
  TemporalCounts counts;
  if (before_) gather.advance(kept_, counts);
  RecordStore store;
  gather.place({[&](const Look& look) { return seen_through(tracer, view, look); }, options_.width, options_.height,
                tool_.progress_sink()},
               kept_, store, counts);
  tool_.stats().phase("write");
  write_cache(options_, frame, store, history, cache_output);
  files_.write(kept_, frame, points, history, kept_output.is_stdout() ? "" : kept_output.path(), kept_output.sink());
  kept_output.commit();
  tool_.stats().end_phase();
  count(tool_, counts, number, !before_);
  before_.emplace(std::move(frame));
  places_hash_ = points.places_hash;
}

}  // namespace

void gather_frames(Tool& tool, SceneInput& input, const TemporalGatherOptions& options) {
  GatherRun run(tool, input, options);
  for (const int frame : tool.common().frames) run.gather(frame);
}

}  // namespace tempolux::tools
