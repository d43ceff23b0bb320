// st-filter -- frames of few samples filtered in space and along the pixel flow in time.
//
//     st-filter f.0008.exr f.0009.exr f.0010.exr f.0011.exr f.0012.exr -o 10.exr
//     st-filter f.####.exr --flow flow.####.exr --frames 0-47 -o filtered.####.exr
//     st-filter mesh room.glb --frame 12 --photons 12.photons -o 12.meshirrad          (tools/stages/filter_mesh.h)
//     st-filter blur f.####.exr --frames 0-47 --shutter 180 -o blurred.####.exr        (tools/stages/blur_frames.h)
//
// Frames of frame-render --channels halves,... are filtered where their halves prove that it pays. How:
// docs/methods/st-filter.md. Channels: formats/frames/frames.md; flow: formats/flow/flow.md.
#include <string_view>

#include "tools/common/cli.h"
#include "tools/common/keep_memory.h"
#include "tools/stages/blur_frames.h"
#include "tools/stages/filter_frames.h"
#include "tools/stages/filter_mesh.h"

using namespace tempolux;

int main(int argc, char** argv) {
  if (argc > 1 && std::string_view(argv[1]) == "mesh") return tools::filter_mesh(argc - 1, argv + 1);
  if (argc > 1 && std::string_view(argv[1]) == "blur") return tools::blur_frames(argc - 1, argv + 1);
  tools::Tool tool("st-filter",
                   "Filter frames in space and along the pixel flow, where halves of their samples show that it helps.",
                   argc, argv);
  tools::FilterFramesOptions options;
  CLI::App& app = tool.app();
  tool.file_option("input", options.frames,
                   "frames in the order of time, EXR, or with --frames a pattern such as f.####.exr")
      ->required();
  tool.file_option("--flow", options.flow,
                   "pixel flow of the frames, EXR, one file per frame, or a pattern; if not given: the frames' own "
                   "channels forward and backward");
  app.add_option("--frames", options.range,
                 "filter these frames, each with the two before and after it in this range: 0-47")
      ->type_name("SPEC");
  tool.number_option("--position", options.position, 0, 1 << 20,
                     "number of the input frame that is filtered; 1: the first; 0: the middle one");
  tool.list_option("--channels", options.channels,
                   "channels of the output, by groups: RGBA, layers, Z, N, id, albedo, motion ...; if not given: all "
                   "channels of the frame");
  tool.output_option(options.output, "EXR file, or a pattern as f.####.exr")->required();
  tool.common_options(0);
  return tool.run([&] {
    tools::keep_memory_of_pictures();
    tool.check_frame_output(options.output);
    tools::filter_frames(tool, options);
    return tools::exit_ok;
  });
}
