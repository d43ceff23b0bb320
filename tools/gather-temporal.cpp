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
#include <algorithm>
#include <string_view>
#include <vector>

#include "formats/error.h"
#include "tools/common/cli.h"
#include "tools/stages/gather_frames.h"
#include "tools/stages/photon_windows.h"

using namespace tempolux;

namespace {

void check(const tools::Tool& tool, const tools::TemporalGatherOptions& options) {
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

void add_options(tools::Tool& tool, tools::TemporalGatherOptions& options) {
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
  tool.number_option("--rays", options.gather.rays, 1, 1 << 20,
                     "gather rays per record, one through each cell of its hemisphere");
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
  tools::TemporalGatherOptions options;
  add_options(tool, options);
  tool.common_options(tools::uses_scene | tools::uses_seed | tools::uses_camera | tools::uses_frames);

  return tool.run([&] {
    check(tool, options);
    tool.stats().phase("load");
    tools::SceneInput input(tool, options.scene(), tools::SceneInput::light | tools::SceneInput::a_camera);
    tools::gather_frames(tool, input, options);
    return tools::exit_ok;
  });
}
