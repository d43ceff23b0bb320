#include "tools/stages/photon_windows.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "formats/text_header.h"
#include "lib/temporal/photon_windows.h"
#include "tools/common/cli.h"
#include "tools/stages/count_photons.h"

namespace tempolux::tools {
namespace {

struct Options {
  std::string scene, output;
  std::vector<std::string> counts;
  CountOptions count;
  WindowOptions window;
};

/// The counts of a frame, with the header of their file.
struct Counted {
  formats::MeshirradHeader header;
  FrameCounts counts;
};

/// Counts of frames: each is read or made once, and kept as long as a window needs it.
class Counts {
 public:
  /// `range`: the requested frames, ascending.
  Counts(Tool& tool, SceneInput& input, const Options& options, const std::vector<int>& range, StaticTree& tree)
      : tool_(tool), input_(input), options_(options), range_(range), tree_(tree) {
    if (!options.count.photons.empty() || (options.counts.size() == 1 && has_frame_pattern(options.counts[0]))) return;
    for (const std::string& name : options.counts) {
      std::shared_ptr<Counted> counted = read(name);
      if (!kept_.emplace(counted->counts.frame, counted).second)
        throw InputError(name + ": counts of frame " + std::to_string(counted->counts.frame) + " are named twice");
    }
    named_ = true;
  }
  /// The counts of a frame and its neighbours in the range; `at` receives the frame's own index.
  std::vector<std::shared_ptr<const Counted>> around(const SceneFrame& frame, std::size_t& at) {
    std::vector<std::shared_ptr<const Counted>> found;
    const int first = std::max(frame.frame - options_.window.reach, frame.segment.first);
    const int last = std::min(frame.frame + options_.window.reach, frame.segment.last);
    std::erase_if(kept_, [&](const auto& kept) { return !named_ && kept.first < first; });
    for (int f = first; f <= last; ++f) {
      const bool here = named_ ? kept_.contains(f) : std::ranges::binary_search(range_, f);
      if (!here && f < frame.frame) found.clear();
      if (!here && f == frame.frame)
        throw InputError("frame " + std::to_string(f) +
                         " has no counts; name those that st-filter mesh --counts made of it");
      if (!here && f > frame.frame) break;
      if (!here) continue;
      if (f == frame.frame) at = found.size();
      found.push_back(of(f));
    }
    return found;
  }

 private:
  std::shared_ptr<const Counted> of(int number) {
    if (const auto found = kept_.find(number); found != kept_.end()) return found->second;
    return kept_[number] = options_.count.photons.empty() ? read(frame_name(options_.counts[0], number)) : make(number);
  }
  std::shared_ptr<Counted> make(int number) {
    const SceneFrame frame = input_.at(number);
    return keep(count_photons(tool_, input_, options_.count, Tracer(frame, tree_)).file);
  }
  std::shared_ptr<Counted> read(const std::string& name) {
    tool_.stats().phase("read counts");
    tool_.depends_on(name);
    formats::MeshirradFile file = formats::load_meshirrad(name);
    if (file.header.holds != formats::MeshHolds::counts)
      throw InputError(name + ": holds no counts; make it with st-filter mesh --counts");
    if (!file.header.identity.known())
      throw InputError(name + ": does not say of which frame it is; make it with st-filter mesh --counts");
    return keep(std::move(file));
  }
  static std::shared_ptr<Counted> keep(formats::MeshirradFile file) {
    const auto counted = std::make_shared<Counted>();
    counted->header = std::move(file.header);
    counted->counts.frame = counted->header.identity.first_frame;
    counted->counts.jump = counted->header.jump;
    for (const formats::MeshElement& e : file.elements)
      if (e.photons > 0) counted->counts.elements.push_back(e);
    return counted;
  }

  Tool& tool_;
  SceneInput& input_;
  const Options& options_;
  const std::vector<int>& range_;
  StaticTree& tree_;
  bool named_ = false;  ///< true if counts are given as a list of names, not as a pattern or photons
  std::map<int, std::shared_ptr<const Counted>> kept_;
};

/// Unit of the windows' sums, W: the unit of the frame's counts, but at least 2^-10 of the largest unit in the window.
/// Counts of one frame reach about 2^44 in their own unit, so in the windows' unit they reach at most 2^54. A frame
/// without light has an arbitrary tiny unit.
double unit_of(const std::vector<std::shared_ptr<const Counted>>& found, std::size_t at) {
  double unit = found[at]->header.unit;
  for (const auto& counted : found) unit = std::max(unit, std::ldexp(counted->header.unit, -10));
  return unit;
}

/// Throws InputError if the counts of a window differ in scene, cell or kinds.
void check_alike(const Counted& here, const Counted& other) {
  const auto& a = here.header;
  const auto& b = other.header;
  if (a.identity.static_geometry != b.identity.static_geometry || a.cell != b.cell || a.kinds != b.kinds ||
      a.origin != b.origin)
    throw InputError("counts of frames " + std::to_string(here.counts.frame) + " and " +
                     std::to_string(other.counts.frame) +
                     " differ in scene, cell or kinds; count all frames of a segment with the same options");
}

void make_windows(Tool& tool, SceneInput& input, const Options& options, Counts& counts, StaticTree& tree, int number) {
  Output output(frame_name(options.output, number));
  tool.stats().phase("evaluate");
  const SceneFrame frame = input.at(number);
  const Tracer tracer(frame, tree);
  std::size_t at = 0;
  const auto found = counts.around(frame, at);
  const Counted& here = *found[at];
  check_identity(tool, frame_name(options.output, number), here.header.identity, frame);
  tool.stats().phase("windows", true);
  formats::MeshirradFile file;
  file.header = here.header;
  file.header.holds = formats::MeshHolds::windows;
  file.header.jump = false;
  file.header.unit = unit_of(found, at);
  file.header.history += tool.history_line(number);
  // Elements of moving surfaces depend on the frames by which they were cut, so these are evaluated again.
  const Segment& s = frame.segment;
  std::vector<SceneFrame> others;
  for (const int f : {s.first, s.first + (s.last - s.first) / 2, s.last})
    others.push_back(f == number ? frame : input.at(f, false));
  file.elements = all_elements(frame, MeshCuts(here.header.cell, {&others[0], &others[1], &others[2]}));
  std::vector<FrameCounts> scaled;  // scaled to the windows' unit
  std::vector<const FrameCounts*> window;
  scaled.reserve(found.size());
  for (const auto& counted : found) {
    check_alike(here, *counted);
    scaled.push_back(counted->counts);
    scaled.back().unit = counted->header.unit / file.header.unit;
    window.push_back(&scaled.back());
  }
  WindowOptions window_options = options.window;
  window_options.width =
      options.count.mesh.filter.width > 0 ? options.count.mesh.filter.width : here.header.cell / kCellOfWindows;
  CollectedLight light = collect_windows(window, at, std::uint32_t(frame.static_count), window_options, file.elements);
  tool.stats().phase("filter", true);
  for (Rgbd& flux : light.flux.mean) flux *= file.header.unit;
  for (double& squares : light.flux.squares) squares *= file.header.unit * file.header.unit;
  file.header.filter = "gaussian " + formats::text_of(window_options.width);
  smooth_by_scales(tracer, light.flux, window_options.width, light.widths, file.elements);
  double frames = 0, lit = 0;
  for (const formats::MeshElement& e : file.elements)
    if (e.photons > 0) frames += 1 + e.before + e.after, ++lit;
  leave_out_dark(file.elements);
  write_mesh(tool, file, output);
  if (lit > 0) tool.stats().set("mean_window." + std::to_string(number), frames / lit);
}

void check(const Tool& tool, const Options& options) {
  if (options.counts.empty() == options.count.photons.empty())
    throw InputError(
        "--photons or --counts: name the photons of the frames, or what st-filter mesh --counts made of them");
  tool.check_patterns({options.output, options.count.photons});
}

}  // namespace

int photon_windows(int argc, char** argv) {
  Tool tool("gather-temporal density",
            "Make light textures from the photons of many frames: each element takes as many frames as its light stays "
            "constant.",
            argc, argv);
  Options options;
  options.count.for_windows = true;
  CLI::App& app = tool.app();
  app.add_option("scene", options.scene, "glTF 2.0 scene, .gltf or .glb")->required();
  add_count_options(tool, options.count);
  tool.leave_out_of_history(
      app.add_option("--counts", options.counts,
                     "in place of photons: .meshirrad files of st-filter mesh --counts, of the frame and those around "
                     "it, or a pattern")
          ->type_name("FILE..."));
  tool.number_option("--reach", options.window.reach, 0, 127, "frames that a window reaches to each side at most");
  tool.number_option("--false-alarms", options.window.false_alarms, 1e-9, 0.5,
                     "share of windows that end too early although light is constant");
  tool.number_option("--filter-width", options.count.mesh.filter.width, 0, kNoLimit,
                     "deviation of the narrowest Gaussian by which elements are smoothed, m; 0: half of --cell");
  tool.output_option(options.output, ".meshirrad file, or a pattern")->required();
  tool.common_options(uses_scene | uses_camera | uses_frames);
  return tool.run([&] {
    std::vector<int> frames = tool.common().frames;
    std::ranges::sort(frames);  // each frame is read once
    check(tool, options);
    options.count.frames = 2 * options.window.reach + 1;
    tool.stats().phase("load");
    SceneInput input(tool, options.scene, SceneInput::nothing);
    StaticTree tree;
    Counts counts(tool, input, options, frames, tree);
    for (const int& frame : frames) {
      make_windows(tool, input, options, counts, tree, frame);
      tool.progress(double(&frame - frames.data() + 1) / double(frames.size()));
    }
    return exit_ok;
  });
}

}  // namespace tempolux::tools
