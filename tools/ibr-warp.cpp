// ibr-warp -- make a frame from key frames: warp their pixels by depth, write the pixel flow, and mark the pixels that
// must be traced.
//
//     ibr-warp key.0008.exr key.0016.exr --scene room.glb --frame 12 -o f.0012.exr
//              --flow flow.0012.exr --mask why.0012.exr
//     frame-render room.glb --frame 12 --base f.0012.exr --mask why.0012.exr -o f.0012.exr ...
//     ibr-warp left.exr --view right.exr -o warped.exr --mask why.exr
//
// Method: docs/methods/warping.md. Formats: formats/flow/flow.md, formats/mask/mask.md.
#include <algorithm>
#include <string>
#include <vector>

#include "formats/error.h"
#include "lib/aqm/vision_model.h"
#include "lib/core/formatted.h"
#include "lib/image/channel_groups.h"
#include "lib/render/data_channels.h"
#include "lib/warp/warped_image.h"
#include "tools/common/cli.h"
#include "tools/common/keep_memory.h"
#include "tools/stages/warp_frames.h"

using namespace tempolux;

namespace {

void check(const tools::Tool& tool, tools::WarpFramesOptions& options, bool several) {
  if (options.scene.empty() == options.view.empty())
    throw InputError(
        "say what to make: a frame of a scene by --scene SCENE --frame F, or what another frame shows by --view FILE");
  if (options.keys.size() > 2) throw InputError("more than two keys; give the one before and the one after the frame");
  tool.check_frame_output(options.output);
  tool.check_patterns({options.flow, options.mask});
  if (!options.view.empty() && (several || !options.flow.empty()))
    throw InputError("--view: shows one frame and knows no others; --frames and --flow need --scene");
  for (const std::string& group : options.channels)
    if (group == "RGBA" || group == "layers" || std::ranges::count(kFrameLayers, group) > 0)
      throw InputError("--channels: '" + group +
                       "' is colour, which comes from the keys; name data: Z, N, P, id, albedo, motion");
  if (asked(options.channels, "cryptomatte"))
    throw InputError("--channels: cryptomatte cannot be warped; frame-render --mask --base counts it for all pixels");
  check_channels(options.channels);
  if (options.warp.slow_deg_per_s < 0) options.warp.slow_deg_per_s = vision::slow_speed(tools::kPixelsPerDegree);
}

void add_options(tools::Tool& tool, tools::WarpFramesOptions& options) {
  CLI::App& app = tool.app();
  app.add_option("keys", options.keys,
                 "one or two rendered frames, EXR with RGBA, Z and their camera; with N and id better")
      ->type_name("KEY")
      ->required();
  tool.file_option("--scene", options.scene, "glTF 2.0 scene of the keys; --frame is the frame to make");
  tool.file_option("--view", options.view, "EXR file whose camera and Z define the picture to make");
  tool.output_option(options.flow, "pixel flow, EXR, or a pattern", "--flow");
  tool.output_option(options.mask, "pixels that must be traced, with causes, EXR, or a pattern", "--mask");
  app.add_flag("--separate", options.warp.separate,
               "also write NAME_1.exr and NAME_2.exr: the frame from each key alone");
  tool.list_option("--channels", options.channels,
                   "data channels besides the keys' colour: Z, N, P, id, albedo, motion");
  tool.number_option("--edge-share", options.warp.edge_share, 0, tools::kNoLimit,
                     "edge pixels are masked if the keys differ by more than this share of the light");
  tool.number_option("--slow", options.warp.slow_deg_per_s, -1, tools::kNoLimit,
                     formatted("moving pixels slower than this are masked, degrees/s; -1: %.3g, half a pixel between "
                               "two frames",
                               vision::slow_speed(tools::kPixelsPerDegree)));
  tool.choice_option("--compression", options.compression, {"zip", "none"}, "EXR compression");
  tool.output_option(options.output, "EXR file, or a pattern as f.####.exr")->required();
}

}  // namespace

int main(int argc, char** argv) {
  tools::Tool tool("ibr-warp",
                   "Make a frame from key frames by depth, with pixel flow and a mask of the pixels to trace.", argc,
                   argv);
  tools::WarpFramesOptions options;
  add_options(tool, options);
  tool.common_options(tools::uses_scene | tools::uses_camera | tools::uses_frames);
  return tool.run([&] {
    tools::keep_memory_of_pictures();
    check(tool, options, tool.common().frames.size() > 1);
    tool.stats().phase("load");
    const std::vector<tools::LoadedKey> keys = tools::load_keys(tool, options.keys);
    if (keys[0].has_mattes && options.mask.empty())
      tool.warn(keys[0].file +
                ": cryptomatte is left out, as shares of a key are not those of another frame; "
                "frame-render --mask --base counts it anew");
    (options.view.empty() ? tools::warp_frames : tools::warp_view)(tool, options, keys);
    return tools::exit_ok;
  });
}
