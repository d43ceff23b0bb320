// volume-compose -- composites the smoke of a scene over a frame: light from photons and sampled lamps, in slices
// along each ray.
//
//     volume-compose room.glb --frame 12 --photons 12.photons --base 12.exr -o 12.smoke.exr
//     volume-compose room.glb --frame 12 --photons 12.photons --points 12.irradpoints --base 12.exr -o 12.smoke.exr
//     volume-compose room.glb --frames 0-23 --photons p.####.photons --base f.####.exr -o s.####.exr
//
// Method: docs/methods/volume_photons.md.
#include <string>
#include <vector>

#include "lib/core/formatted.h"
#include "tools/common/cli.h"
#include "tools/common/scene_input.h"
#include "tools/common/tool_main.h"
#include "tools/stages/compose_smoke.h"

using namespace tempolux;

namespace {

void add_options(tools::Tool& tool, tools::SmokeOptions& options) {
  CLI::App& app = tool.app();
  app.add_option("scene", options.scene, "glTF 2.0 scene, .gltf or .glb")->required();
  tool.file_option("--photons", options.photons, ".photons file with photons in media, or a pattern")->required();
  tool.file_option(
      "--points", options.points,
      ".irradpoints file, or a pattern: rays from the eye find light in a peak of the phase function and end at "
      "these points; without points photons give this light, with more noise. Read only if |g| is above about .7");
  tool.file_option("--base", options.base, "EXR frame to put the smoke into, or a pattern")->required();
  tool.choice_option("--direct", options.direct, {"rays", "photons"},
                     "direct light: rays: lamps are sampled, with shadows; photons: by density, as all other light");
  tool.number_option("--spp", options.compose.samples, 1, 4096, "rays per pixel");
  tool.number_option("--light-samples", options.compose.light_samples, 1, 4096, "samples of the lamps for each ray");
  tool.number_option("--cell", options.light.cell, 0, tools::kNoLimit,
                     "edge of the cells in which photons are summed, m; 0: that of the finest voxel");
  tool.number_option(
      "--filter-width", options.light.filter_width, 0, 64,
      formatted("standard deviation of the Gaussian that smooths them, cells; 0: so wide that %g photons "
                "count",
                double(kPhotonsInFilter)));
  app.add_flag("--half", options.half_float, "colour as 16-bit floats; refuses values above 65504");
  tool.output_option(options.output, "EXR file, or a pattern as f.####.exr")->required();
}

}  // namespace

int main(int argc, char** argv) {
  tools::Tool tool("volume-compose", "Composite the smoke of a scene over a frame, lit by photons and sampled lamps.",
                   argc, argv);
  tools::SmokeOptions options;
  add_options(tool, options);
  tool.common_options(tools::uses_scene | tools::uses_seed | tools::uses_camera | tools::uses_frames);
  return tool.run([&] {
    const std::vector<int>& frames = tool.common().frames;
    tool.check_frame_output(options.output);
    options.light.direct = options.direct == "photons";
    options.compose.sample_lights = !options.light.direct;
    tool.stats().phase("load");
    tools::SceneInput input(tool, options.scene, tools::SceneInput::light | tools::SceneInput::a_camera);
    StaticTree tree;
    for (const int frame : frames) compose_smoke(tool, input, options, frame, tree);
    return tools::exit_ok;
  });
}
