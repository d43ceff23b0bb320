#include "tools/stages/plan_range.h"

#include <algorithm>
#include <map>
#include <optional>
#include <sstream>

#include "formats/error.h"
#include "lib/render/data_channels.h"
#include "tools/common/cli.h"
#include "tools/stages/measured.h"
#include "tools/stages/planning.h"
#include "tools/stages/samples.h"

namespace tempolux::tools {
namespace {

/// The wish in full, its words checked.
Wish wish_of(Tool& tool, const PlanOptions& options) {
  Wish wish = options.wish;
  wish.quality = *named<Quality>(kQualities, options.quality);
  wish.method = *named<FrameMethod>(kFrameMethods, options.method);
  wish.filter = options.filter == "auto" ? Wish::kAutoFilter : options.filter == "none" ? 0 : std::stoi(options.filter);
  wish.camera = tool.common().camera;
  // Collects the shared options that are not part of the scene's states.
  for (const CLI::Option* option : tool.app().get_options())
    if (const auto& shared = kSharedWords; std::ranges::find(shared, option->get_name()) != shared.end())
      for (const std::string& word : option->results()) wish.common += option->get_name() + ' ' + word + '\n';
  for (const std::string& one : options.words) {
    const std::size_t colon = one.find(':');
    const std::map<std::string, std::string*> stages{
        {"points", &wish.points}, {"records", &wish.records}, {"pixels", &wish.pixels}, {"smoke", &wish.smoke_words}};
    const auto stage = stages.find(one.substr(0, colon));
    if (stage == stages.end() || colon == std::string::npos)
      throw InputError("--words '" + one + "': write STAGE:OPTIONS; the stages are points, records, pixels, smoke");
    *stage->second = one.substr(colon + 1);
    check_words("--words " + stage->first, *stage->second);
  }
  for (const auto& [name, words] : {std::pair{"--channels", wish.channels},
                                    {"--update", wish.update},
                                    {"--refine", wish.refine},
                                    {"--strategy", wish.strategy}})
    check_words(name, words);
  std::vector<std::string> channels;
  std::istringstream names(wish.channels);
  for (std::string name; std::getline(names, name, ',');) channels.push_back(name);
  check_channels(channels);  // frame-render would refuse them only after all light
  if (std::ranges::find(channels, "RGBA") == channels.end())
    throw InputError("--channels '" + wish.channels + "': frames need RGBA, the picture; write RGBA," + wish.channels);
  const std::vector<int>& frames = tool.common().frames;
  if (options.report == "ends") wish.report = {frames.front(), frames.back()};
  else if (!options.report.empty()) wish.report = parse_frames(options.report);
  for (const int frame : wish.report)
    if (std::ranges::find(frames, frame) == frames.end())
      throw InputError("--report " + options.report + ": frame " + std::to_string(frame) + " is none of --frames");
  if (!options.shot.empty()) {
    const std::vector<int> shown = parse_frames(options.shot);
    if (shown.back() - shown.front() + 1 != int(shown.size()))
      throw InputError("--shot " + options.shot + ": a shot is a range of frames, as 100-199");
    wish.shot = {shown.front(), shown.back()};
  }
  if (!options.measured.empty()) {
    if (wish.method != FrameMethod::preview || wish.photons > 0)
      throw InputError("--measured: photons of --method preview; leave it out with another method or with --photons");
    wish.measured = measured_photons(options.measured, options.aqm < 0 ? wish.seen() : options.aqm);
  }
  return with_preset(wish);
}

}  // namespace

void plan_range(Tool& tool, const PlanOptions& options, const std::string& arguments, const std::string& shot) {
  const Wish wish = wish_of(tool, options);
  std::optional<PlanFolder> folder;
  if (options.estimate.empty()) folder.emplace(options.folder);
  if (folder && folder->up_to_date(arguments)) return tool.say(options.folder + ": nothing has changed");
  tool.stats().phase("load");
  Planner planner(tool, options.scene, wish, options.recipes, folder ? &*folder : nullptr);
  tool.stats().phase("write");
  if (!folder) return write_samples(options.estimate, planner, wish);
  if (!options.measured.empty()) folder->inputs().hash_of(options.measured);
  folder->write(planner.planned(), planner.tool_hash(), arguments, shot);
  for (const PlannedSegment& segment : planner.planned().plan.segments)
    for (const Reason& reason : segment.decisions.reasons)
      tool.say("frames " + std::to_string(segment.first) + "-" + std::to_string(segment.last) + ": " + reason.stage +
               ": " + reason.because);
}

}  // namespace tempolux::tools
