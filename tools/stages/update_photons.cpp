#include "tools/stages/update_photons.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "formats/error.h"
#include "formats/photons/layout.h"
#include "lib/core/machine_memory.h"
#include "lib/photon/photon_ledger.h"
#include "lib/photon/photon_refine.h"
#include "tools/common/arguments.h"
#include "tools/common/cli.h"
#include "tools/common/option_words.h"
#include "tools/common/percent_option.h"

namespace tempolux::tools {
namespace {

const std::map<std::string, UpdateStrategy> kStrategies{
    {"oldest", UpdateStrategy::oldest}, {"random", UpdateStrategy::random}, {"census", UpdateStrategy::census},
    {"fde", UpdateStrategy::fde},       {"dip", UpdateStrategy::dip},       {"hybrid", UpdateStrategy::hybrid},
    {"path", UpdateStrategy::path},     {"all", UpdateStrategy::all}};

/// Converts "10%" or "0.1" to .1, as percent() does for other options.
double share_of(const std::string& text, const char* option) {
  double share = -1;
  if (const std::optional<double> percent = share_in_percent(text)) share = *percent;
  else if (!CLI::detail::lexical_cast(text, share)) share = -1;
  if (!(share >= 0 && share <= 1))
    throw InputError(std::string(option) + ": '" + text + "' is not a share; write 10% or 0.1");
  return share;
}

/// True if all states of the scene that light depends on are the map's.
bool is_still(const formats::Identity& a, const formats::Identity& b) {
  return a.known() && a.static_geometry == b.static_geometry && a.moving_geometry == b.moving_geometry &&
         a.materials == b.materials && a.lights == b.lights && a.media == b.media;
}

/// --refine reads the map of the frame itself, --update the map of the previous frame.
std::string previous_name(const UpdateArguments& arguments, int frame) {
  return frame_name(arguments.update, arguments.refine > 0 ? frame : frame - 1);
}

/// Number of groups that fit into the share besides `spent` paths of pilots.
std::uint64_t most_groups(const UpdateArguments& arguments, const PhotonTracer& photons, std::uint64_t spent) {
  if (arguments.share.empty()) return 0;
  const double paths = share_of(arguments.share, "--share") * double(photons.photon_count()) - double(spent);
  const double groups = paths / double(photons.members());
  return std::uint64_t(std::max(0.0, spent > 0 ? std::floor(groups) : std::ceil(groups)));
}

/// True if the map takes at most a quarter of the memory.
bool may_keep(const Tool& tool, std::uint64_t photons) {
  constexpr std::uint64_t bytes_of_photon = sizeof(formats::Photon) + sizeof(std::array<std::uint16_t, 2>);
  std::uint64_t memory = machine_memory();
  if (const std::uint64_t limit = tool.common().max_memory_bytes; limit > 0) memory = std::min(memory, limit);
  return photons <= memory / 4 / bytes_of_photon;
}

void check_updatable(const std::string& name, const MapToUpdate& map, const formats::PhotonHeader& previous,
                     bool any_count) {
  formats::PhotonHeader wanted = map.header;
  describe_map(map.photons, wanted);
  if (any_count) wanted.emitted_count = previous.emitted_count;
  if (const std::string why = why_not_updatable(previous, wanted); !why.empty())
    throw InputError(name + ": cannot be " + (any_count ? "refined" : "updated") + ": " + why +
                     "; trace this frame anew, without --update");
}

PhotonMapResult refine_map(Tool& tool, const std::string& name, std::uint64_t extra, const MapToUpdate& map,
                           const std::function<void(const void*, std::size_t)>& sink) {
  const formats::PhotonHeader previous = formats::PhotonReader(name, {.digest = false}).header();
  check_updatable(name, map, previous, true);
  if (!is_still(previous.identity, map.header.identity))
    throw InputError(name + ": is the map of another state of the scene; --refine takes that of frame " +
                     std::to_string(map.frame.frame));
  const GroupMoments groups = read_moments(name, map.photons);
  formats::PhotonHeader header = map.header;
  header.history = previous.history + map.header.history;
  const PhotonMapResult result = write_refined_map(map.photons, header, name, groups, extra, sink);
  tool.stats().count("paths_added", double(extra));
  return result;
}

}  // namespace

void add_update_options(Tool& tool, UpdateArguments& arguments) {
  tool.file_option("--update", arguments.update,
                   "map of the previous frame, or a pattern: its groups are kept, except those that are traced again; "
                   "needs photons in media and --majorants");
  CLI::App& app = tool.app();
  app.add_option("--share", arguments.share,
                 "with --update: share of the paths that are traced again, such as 10%, including pilots")
      ->type_name("PERCENT");
  std::vector<std::string> names;
  for (const auto& [name, strategy] : kStrategies) names.push_back(name);
  tool.choice_option(
      "--strategy", arguments.strategy, names,
      "groups that are traced again first. oldest; random; census: groups whose stored photons saw the "
      "largest change of smoke. By pilots: fde: pilots that see another extinction; dip: pilots that smoke "
      "scatters at other places; hybrid: the amount of change along pilots; path: pilots that take another "
      "path. all: every group. Priorities are multiplied by age, except for oldest and random");
  app.add_option("--pilots", arguments.pilots,
                 "for a map that will be updated by pilots: share of each group's paths that are pilots, such as 3%; "
                 "at least one path, at most " +
                     std::to_string(formats::photons::kMostPilots))
      ->type_name("PERCENT")
      ->capture_default_str();
  // For comparison with the papers, so --help does not show it: docs/methods/volume_photons.md.
  app.add_option("--age-power", arguments.how.age_power,
                 "of --update: priorities are times age to this power; 0: as in the papers")
      ->group("")
      ->check(number_between(0, 16));
  tool.count_option(
      "--refine", arguments.refine,
      "add this many paths (10k, 1M) to the groups in which they reduce the noise of light in smoke most, "
      "instead of tracing groups again; --update is then the map of the frame itself");
}

void check_update_arguments(const Tool& tool, bool static_or_dynamic, UpdateArguments& arguments) {
  const bool refines = arguments.refine > 0;
  arguments.how.strategy = kStrategies.at(arguments.strategy);
  if (static_or_dynamic && arguments.updates()) throw InputError("--update: only with --map global");
  if (!arguments.updates() && refines)
    throw InputError("--refine: name the map that gets further paths, --update FILE");
  if (refines && !arguments.share.empty())
    throw InputError("--refine: adds paths; --share traces some again: use one or the other");
  if (arguments.updates() && share_of(arguments.pilots, "--pilots") > 0)
    throw InputError("--pilots: of an update the map before has them");
  if (!arguments.updates()) return;
  if (!refines && arguments.share.empty() && arguments.strategy != "all")
    throw InputError("--update: say how many groups to trace again, --share 10%");
  if (tool.common().volume.majorants.empty())
    throw InputError(
        "--update: needs the --majorants of the segment (scene-plan writes state/FRAME-KEY.majorants): without them "
        "photons look at other places in each frame");
}

void set_groups(const UpdateArguments& arguments, int frame, PhotonOptions& photons) {
  if (arguments.updates()) {
    const formats::PhotonHeader previous =
        formats::PhotonReader(previous_name(arguments, frame), {.digest = false}).header();
    photons.pilots = previous.pilots;
    if (arguments.refine > 0) photons.group_count = previous.group_count;
    return;
  }
  photons.pilots = 0;
  const double share = share_of(arguments.pilots, "--pilots");
  if (!(share > 0)) return;
  const std::uint32_t groups =
      photons.group_count ? photons.group_count : automatic_group_count(photons.photon_count, true);
  photons.pilots = std::uint32_t(
      std::clamp(std::ceil(share * double(photons.photon_count) / groups), 1.0, double(formats::photons::kMostPilots)));
}

PhotonMapResult update_map(Tool& tool, const UpdateArguments& arguments, const MapToUpdate& map,
                           const std::function<void(const void*, std::size_t)>& sink, KeptMap& kept) {
  const int frame = map.frame.frame;
  const std::string name = previous_name(arguments, frame);
  tool.depends_on(name, InputRole::replaceable);
  if (arguments.refine > 0) return refine_map(tool, name, arguments.refine, map, sink);
  // If nothing has changed no group is traced, so changes need not be measured.
  const bool is_here = kept.name == name && kept.map.is_kept();
  const formats::PhotonHeader before =
      is_here ? kept.map.header : formats::PhotonReader(name, {.digest = false}).header();
  check_updatable(name, map, before, false);
  const bool still = is_still(before.identity, map.header.identity);
  const UpdateStrategy strategy =
      still && arguments.how.strategy != UpdateStrategy::all ? UpdateStrategy::oldest : arguments.how.strategy;
  PreviousMap& previous = kept.map;
  if (!is_here) {
    tool.stats().phase("read map");
    const bool keep =
        kept.wanted && may_keep(tool, formats::PhotonReader(name, {.digest = false}).photon_count_bound());
    previous = read_previous(name, map.photons, strategy, map.frame.origin, keep);
  }
  if (previous.is_kept()) {
    tool.stats().phase(sends_pilots(strategy) ? "pilots" : "census", true);
    find_change(name, previous, map.photons, strategy, map.frame.origin);
  }
  kept.name.clear();
  tool.stats().phase("choose");
  UpdateOptions how = arguments.how;
  how.most_groups = most_groups(arguments, map.photons, previous.pilot_paths);
  const std::vector<std::uint32_t> groups = choose_groups(previous, frame, still, how);
  tool.stats().count("groups_updated", double(groups.size()));
  if (previous.pilot_paths > 0) tool.stats().count("pilot_paths", double(previous.pilot_paths));

  tool.stats().phase("trace", true);
  formats::PhotonHeader header = map.header;
  header.history = before.history + map.header.history;
  const auto folder = [](const std::string& path) { return path.substr(0, path.rfind('/') + 1); };
  MapUpdate update{name, previous, groups, map.output != "-" && folder(map.output) == folder(name)};
  const PhotonMapResult result = write_updated_map(map.photons, header, update, sink);
  if (previous.is_kept()) kept.name = map.output;
  return result;
}

}  // namespace tempolux::tools
