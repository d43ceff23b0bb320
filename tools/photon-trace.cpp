// photon-trace -- trace photons from the lights of a scene and record where they arrive.
//
//     photon-trace room.glb --frame 12 --photons 1M -o photons.0012.photons
//     photon-trace room.glb --frames 0-47 --photons 1M -o photons.####.photons
//
// Format: formats/photons/photons.md.
#include <CLI/CLI.hpp>
#include <cmath>
#include <functional>
#include <string>
#include <vector>

#include "formats/photons/layout.h"
#include "lib/photon/photon_map.h"
#include "lib/photon/photon_ledger.h"
#include "lib/photon/photon_update.h"
#include "tools/common/option_words.h"
#include "tools/common/scene_input.h"
#include "tools/common/tool_main.h"

using namespace tempolux;

namespace {

struct Options {
  std::string scene, output, photons = "1M", kinds = "direct,caustic,indirect", groups = "auto";
  float volume_share = PhotonOptions{}.volume_share;
  std::string update, share, strategy = "oldest";
  std::uint64_t max_groups = 0;
  UpdateOptions updating;
};

/// "10%" of the groups, rounded up.
std::uint64_t groups_of(const std::string& share, std::uint32_t group_count) {
  std::size_t read = 0;
  double percent = -1;
  try {
    percent = std::stod(share, &read);
  } catch (const std::exception&) {
  }
  if (!(percent >= 0 && percent <= 100) || (share.substr(read) != "%" && read != share.size()))
    throw InputError("--share: '" + share + "' is not a share; write 10% or 2.5%");
  return std::uint64_t(std::ceil(percent / 100 * group_count));
}

/// 0 stands for automatic.
std::uint32_t group_count(const std::string& text) {
  if (text == "auto") return 0;
  const std::uint64_t count = tools::parse_count(text);
  if (count < 1 || count > formats::photons::kMaxGroupCount)
    throw InputError("--groups: " + text + " is not in 1 .. " + std::to_string(formats::photons::kMaxGroupCount));
  return std::uint32_t(count);
}

/// Are all states of the scene that light depends on those of the map?
bool is_still(const formats::Identity& a, const formats::Identity& b) {
  return a.known() && a.static_geometry == b.static_geometry && a.moving_geometry == b.moving_geometry && a.materials == b.materials &&
         a.lights == b.lights && a.media == b.media;
}

PhotonMapResult update_map(tools::Tool& tool, const Options& options, const PhotonTracer& photons, const PhotonOptions& photon_options,
                           const formats::PhotonHeader& header, const SceneFrame& frame,
                           const std::function<void(const void*, std::size_t)>& sink) {
  const std::string previous_name = tools::frame_name(options.update, frame.frame - 1);
  const bool census = options.updating.strategy == UpdateStrategy::census;
  const PreviousMap previous = read_previous(previous_name, photons, census, frame.origin);
  tool.depends_on(previous_name, tools::InputRole::replaceable);
  formats::PhotonHeader wanted = header;
  describe_map(photons, photon_options, wanted);
  if (const std::string why = why_not_updatable(previous.header, wanted); !why.empty())
    throw InputError(previous_name + ": cannot be updated: " + why + "; trace this frame anew, without --update");
  UpdateOptions updating = options.updating;
  updating.most_groups = options.max_groups;
  if (!options.share.empty()) updating.most_groups = groups_of(options.share, photons.group_count());
  const std::vector<std::uint32_t> groups =
      choose_groups(previous, frame.frame, is_still(previous.header.identity, header.identity), updating);
  tool.stats().count("groups_updated", double(groups.size()));
  const std::string output = tools::frame_name(options.output, frame.frame);
  const auto folder = [](const std::string& path) { return path.substr(0, path.rfind('/') + 1); };
  formats::PhotonHeader with_history = header;
  with_history.history = previous.header.history + header.history;
  return write_updated_map(photons, photon_options, with_history, previous_name, previous, groups,
                           output != "-" && folder(output) == folder(previous_name), sink);
}

void trace_frame(tools::Tool& tool, tools::SceneInput& input, const Options& options, int frame_number,
                 StandingTree& standing) {
  tools::Output output(tools::frame_name(options.output, frame_number), tool.common().no_clobber);
  tool.stats().phase("evaluate");
  const SceneFrame frame = input.at(frame_number);
  const EmissionTable& emission = input.emission(frame.frame);
  tool.stats().phase("build");
  const Tracer tracer(frame, standing);
  const Lights lights(frame, emission);

  PhotonOptions photon_options;
  photon_options.seed = tool.common().seed_for_frame(frame_number);
  photon_options.photon_count = tools::parse_count(options.photons);
  photon_options.group_count = group_count(options.groups);
  photon_options.set_kinds(options.kinds);
  photon_options.volume_share = options.volume_share;
  formats::PhotonHeader header;
  header.history = tool.history_line(frame_number);
  header.identity = tools::identity_of(frame);
  header.identity.emission = emission_hash(emission, frame.segment);
  header.origin = {frame.origin.x, frame.origin.y, frame.origin.z};

  tool.stats().phase("trace", true);
  const PhotonTracer photons(tracer, lights, photon_options);
  const auto sink = [&](const void* data, std::size_t size) { output.write(data, size); };
  const PhotonMapResult result =
      options.update.empty()
          ? write_photon_map(photons, photon_options, header, sink, [&](double fraction) { tool.progress(fraction); })
          : update_map(tool, options, photons, photon_options, header, frame, sink);
  tool.stats().phase("commit");
  output.commit();
  tool.stats().end_phase();
  tool.stats().count("photons", double(result.totals.photon_count));
  tool.stats().count("paths", double(result.path_count));
  tool.stats().count("rays", double(result.ray_count));
  tool.stats().count("specular_rays", double(result.specular_ray_count));
  if (frame.media) tool.stats().count("medium_steps", double(result.medium_steps));
  tool.stats().count("bytes_written", double(result.byte_count));
  tool.stats().count("refused_rays", double(tracer.refused_ray_count()));
}

}  // namespace

int main(int argc, char** argv) {
  tools::Tool tool("photon-trace", "Trace photons from the lights of a scene and record where they arrive.", argc,
                   argv);
  Options options;
  CLI::App& app = tool.app();
  app.add_option("scene", options.scene, "glTF 2.0 scene, .gltf or .glb")->required();
  app.add_option("--photons", options.photons,
                 "photon paths to start per frame (10k, 1M, 1G), rounded up to a multiple of the groups")
      ->capture_default_str();
  app.add_option("--kinds", options.kinds, "kinds of light to record: direct,caustic,indirect, and volume, which is recorded where there is a medium")->capture_default_str();
  app.add_option("--groups", options.groups, "photon groups N_g (photon i is of group i mod N_g), or auto")
      ->capture_default_str();
  app.add_option("-o,--output", options.output, ".photons file, or a pattern as f.####.photons; - for standard output")
      ->required();
  app.add_option("--update", options.update,
                 "map of the frame before, or a pattern: keep its groups but for those that are traced again; needs photons in media and "
                 "--majorants")
      ->type_name("FILE");
  app.add_option("--share", options.share, "of --update: share of the groups that is traced again, as 10%")->type_name("PERCENT");
  app.add_option("--max-groups", options.max_groups, "of --update: instead of a share, their number")->type_name("N");
  app.add_option("--strategy", options.strategy,
                 "which groups go first: oldest; random; census: where the stored photons saw most change, times age; all")
      ->capture_default_str()
      ->check(CLI::IsMember({"oldest", "random", "census", "all"}));
  app.add_option("--age-floor", options.updating.age_floor, "of --update: groups as many frames old go before all others; 0: none")
      ->type_name("FRAMES")
      ->capture_default_str()
      ->check(tools::number_between(0, 1e6));
  app.add_option("--volume-share", options.volume_share, "share of the tentative collisions in media that are recorded")
      ->capture_default_str()
      ->check(tools::number_between(0.001, 1));
  tool.common_options(tools::uses_scene | tools::uses_seed | tools::uses_frames);

  return tool.run([&] {
    const std::vector<int>& frames = tool.common().frames;
    if (frames.size() > 1 && !tools::has_frame_pattern(options.output))
      throw InputError("--output: several frames need a pattern, for example f.####.photons");
    using Strategy = UpdateStrategy;
    options.updating.strategy = options.strategy == "census" ? Strategy::census : options.strategy == "random" ? Strategy::random
                                : options.strategy == "all" ? Strategy::all : Strategy::oldest;
    if (!options.update.empty() && options.share.empty() && options.max_groups == 0 && options.strategy != "all")
      throw InputError("--update: say how many groups to trace again, --share 10% or --max-groups N");
    if (!options.update.empty() && tool.common().volume.majorants.empty())
      throw InputError("--update: needs the --majorants of the segment (scene-plan writes state/majorants.FFFF): without them photons look at "
                       "other places in each frame");
    tool.stats().phase("load");
    tools::SceneInput input(tool, options.scene, tools::SceneInput::light);
    StandingTree standing;
    for (int frame : frames) trace_frame(tool, input, options, frame, standing);
    return tools::exit_ok;
  });
}
