// photon-trace -- trace photons from the lights of a scene and record where they arrive.
//
//     photon-trace room.glb --frame 12 --photons 1M -o photons.0012.photons
//     photon-trace room.glb --frames 0-47 --photons 1M -o photons.####.photons
//
// Format: formats/photons/photons.md.
#include <CLI/CLI.hpp>
#include <string>
#include <vector>

#include "formats/photons/layout.h"
#include "lib/photon/photon_map.h"
#include "tools/common/option_words.h"
#include "tools/common/scene_input.h"
#include "tools/common/tool_main.h"

using namespace tempolux;

namespace {

struct Options {
  std::string scene, output, photons = "1M", kinds = "direct,caustic,indirect", groups = "auto";
  float volume_share = PhotonOptions{}.volume_share;
};

/// 0 stands for automatic.
std::uint32_t group_count(const std::string& text) {
  if (text == "auto") return 0;
  const std::uint64_t count = tools::parse_count(text);
  if (count < 1 || count > formats::photons::kMaxGroupCount)
    throw InputError("--groups: " + text + " is not in 1 .. " + std::to_string(formats::photons::kMaxGroupCount));
  return std::uint32_t(count);
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
  const PhotonMapResult result = write_photon_map(
      photons, photon_options, header, [&](const void* data, std::size_t size) { output.write(data, size); },
      [&](double fraction) { tool.progress(fraction); });
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
  app.add_option("--volume-share", options.volume_share, "share of the tentative collisions in media that are recorded")
      ->capture_default_str()
      ->check(tools::number_between(0.001, 1));
  tool.common_options(tools::uses_scene | tools::uses_seed | tools::uses_frames);

  return tool.run([&] {
    const std::vector<int>& frames = tool.common().frames;
    if (frames.size() > 1 && !tools::has_frame_pattern(options.output))
      throw InputError("--output: several frames need a pattern, for example f.####.photons");
    tool.stats().phase("load");
    tools::SceneInput input(tool, options.scene, tools::SceneInput::light);
    StandingTree standing;
    for (int frame : frames) trace_frame(tool, input, options, frame, standing);
    return tools::exit_ok;
  });
}
