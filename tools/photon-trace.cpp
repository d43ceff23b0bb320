// photon-trace -- trace photons from the lights of a scene and record where they arrive.
//
//     photon-trace room.glb --frame 12 --photons 1M -o photons.0012.photons
//     photon-trace room.glb --frames 0-47 --photons 1M -o photons.####.photons
//     photon-trace room.glb --frame 0 --map static --photons 1M -o s.photons --paths s.paths
//     photon-trace room.glb --frames 0-23 --map dynamic --static s.paths -o d.####.photons
//     photon-trace room.glb --frames 1-23 --majorants m --update p.####.photons --share 10% --strategy census
//                  -o p.####.photons
//
// Formats: formats/photons/photons.md, formats/paths/paths.md. Method: docs/methods/dynamic.md.
#include <string>
#include <vector>

#include "formats/error.h"
#include "tools/common/cli.h"
#include "tools/stages/trace_photons.h"

using namespace tempolux;

namespace {

void check(const CLI::App& app, const tools::TraceOptions& options) {
  if (options.map != "static" && !options.paths.empty()) throw InputError("--paths: only with --map static");
  if (options.output.empty() && options.paths.empty()) throw InputError("-o is required, unless --paths is given");
  if (options.map != "dynamic" && !options.static_paths.empty()) throw InputError("--static: only with --map dynamic");
  if (options.map != "dynamic") return;
  if (options.static_paths.empty())
    throw InputError("--map dynamic needs --static: the .paths file that --map static --paths has written");
  for (const char* name : {"--photons", "--kinds"})
    if (app.get_option(name)->count() > 0)
      throw InputError(std::string(name) + ": not with --map dynamic, which takes it from the static map");
}

}  // namespace

int main(int argc, char** argv) {
  tools::Tool tool("photon-trace", "Trace photons from the lights of a scene and record where they arrive.", argc,
                   argv);
  tools::TraceOptions options;
  CLI::App& app = tool.app();
  app.add_option("scene", options.scene, "glTF 2.0 scene, .gltf or .glb")->required();
  tool.count_option(
      "--photons", options.photons,
      "photon paths to start per frame (10k, 1M, 1G), rounded up to a multiple of their number of groups");
  app.add_option(
         "--kinds", options.kinds,
         "kinds of light to record: direct,caustic,indirect, and volume, which is recorded where there is a medium")
      ->capture_default_str();
  tool.file_option("--importance", options.importance, tools::kImportanceHelp);
  tool.output_option(
      options.output,
      ".photons file, or a pattern as f.####.photons; - for standard output; only with --paths it may be "
      "left out");
  tool.choice_option("--map", options.map, {"global", "static", "dynamic"},
                     "global: the scene at the frame; static: without movers of the frame's segment; dynamic: the "
                     "change that movers make, traced for the touched paths only");
  tool.output_option(options.paths, "with --map static: write the paths that movers can touch, .paths", "--paths");
  tool.file_option("--static", options.static_paths, "with --map dynamic: the .paths file of the segment's static map");
  tools::add_update_options(tool, options.updating);
  tool.common_options(tools::uses_scene | tools::uses_majorants | tools::uses_seed | tools::uses_camera |
                      tools::uses_frames);

  return tool.run([&] {
    check(app, options);
    const std::vector<int>& frames = tool.common().frames;
    tool.check_patterns({options.output});
    tools::check_update_arguments(tool, options.map != "global", options.updating);
    tool.stats().phase("load");
    const unsigned camera = options.importance.empty() ? tools::SceneInput::a_camera : tools::SceneInput::nothing;
    tools::SceneInput input(tool, options.scene, tools::SceneInput::light | camera);
    if (options.map != "global" && input.has_media())
      throw InputError(options.scene + ": has media, which all light meets: --map " + options.map +
                       " cannot be separated from the remaining light; trace the global map");
    tools::PhotonTracing tracing(tool, input, options);
    for (const int& frame : frames) tracing.trace(frame, &frame == &frames.back());
    return tools::exit_ok;
  });
}
