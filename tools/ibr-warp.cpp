// ibr-warp -- make a frame from key frames: warp their pixels by depth, write the pixel flow, and mark the pixels that
// must be traced.
//
//     ibr-warp key.0008.exr key.0016.exr --scene room.glb --frame 12 -o f.0012.exr
//              --flow flow.0012.exr --mask why.0012.exr
//     frame-render room.glb --frame 12 --base f.0012.exr --mask why.0012.exr -o f.0012.exr ...
//     ibr-warp left.exr --view right.exr -o warped.exr --mask why.exr
//
// Method: docs/methods/warping.md. Formats: formats/flow/flow.md, formats/mask/mask.md.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "formats/error.h"
#include "lib/aqm/animation_quality.h"
#include "lib/image/exr_io.h"
#include "lib/image/frame_identity.h"
#include "lib/image/why_mask.h"
#include "lib/render/frame_renderer.h"
#include "lib/warp/flow_of_view.h"
#include "lib/warp/slow_speed.h"
#include "lib/warp/warped_image.h"
#include "tools/common/keep_memory.h"
#include "tools/common/option_words.h"
#include "tools/common/tool_main.h"
#include "tools/stages/warp_keys.h"

using namespace tempolux;

namespace {

constexpr double kPixelsPerDegree = 30;  ///< of the display: 960 pixels across 32 degrees

struct Options {
  std::vector<std::string> keys;
  std::string scene, view, output, flow, mask, compression = "zip";
  std::vector<std::string> channels{"Z", "N", "id"};
  WarpOptions warp{.slow_deg_per_s = -1};

  ExrWriteOptions exr() const {
    return {false, compression == "none" ? ExrWriteOptions::Compression::none : ExrWriteOptions::Compression::zip};
  }
};

/// "f.0012.exr" becomes "f.0012_1.exr".
std::string candidate_name(const std::string& path, std::size_t key) {
  const std::size_t dot = path.rfind('.'), slash = path.rfind('/');
  const std::size_t end = dot == std::string::npos || (slash != std::string::npos && dot < slash) ? path.size() : dot;
  return path.substr(0, end) + '_' + std::to_string(key + 1) + path.substr(end);
}

/// The output files of one frame: created before the work, committed together.
struct Outputs {
  tools::Output frame;
  std::optional<tools::Output> flow, mask;
  std::vector<tools::Output> candidates;

  Outputs(const Options& o, int number) : frame(tools::frame_name(o.output, number)) {
    if (!o.flow.empty()) flow.emplace(tools::frame_name(o.flow, number));
    if (!o.mask.empty()) mask.emplace(tools::frame_name(o.mask, number));
    for (std::size_t k = 0; o.warp.separate && k < o.keys.size(); ++k)
      candidates.emplace_back(candidate_name(tools::frame_name(o.output, number), k));
  }
  void commit() {
    frame.commit();
    if (flow) flow->commit();
    if (mask) mask->commit();
    for (tools::Output& candidate : candidates) candidate.commit();
  }
};

void count_work(tools::Tool& tool, const WarpedFrame& warped) {
  tools::Stats& stats = tool.stats();
  std::uint64_t traced = 0;
  for (const WhyCount& cause : count_whys(warped.why)) {
    std::string name = "traced_" + cause.name;
    std::replace(name.begin(), name.end(), ' ', '_');
    stats.count(name, double(cause.first));
    traced += cause.first;
  }
  stats.count("pixels", double(warped.why.size()));
  stats.count("traced", double(traced));
}

/// Writes a warped frame and takes its colours; `bare` has the size and the attributes.
void write(tools::Tool& tool, const Options& options, Outputs& outputs, WarpedFrame&& warped, const PixelFlow* flow,
           Image image, const Image& bare) {
  tool.stats().phase("write");
  add_colour(warped, image);
  save_exr(outputs.frame.temporary_path(), image, options.exr());
  for (std::size_t k = 0; k < outputs.candidates.size(); ++k) {
    Image candidate = bare;
    add_candidate(warped, k, candidate);
    save_exr(outputs.candidates[k].temporary_path(), candidate, options.exr());
  }
  if (outputs.mask) {
    Image mask = bare;
    mask.add_ids(kWhyChannel).ids = warped.why;
    save_exr(outputs.mask->temporary_path(), mask, options.exr());
  }
  if (outputs.flow) {
    Image image_of_flow = bare;
    add_flow_channels(*flow, image_of_flow);
    save_exr(outputs.flow->temporary_path(), image_of_flow, options.exr());
  }
  outputs.commit();
  tool.stats().end_phase();
  count_work(tool, warped);
}

/// Adds the requested channels besides colour.
void add_data(const Options& options, tools::SceneInput& input, tools::FramesOfScene& frames, const Tracer& tracer,
              const SceneView& seen, int number, Image& image) {
  const auto plain = [](const std::string& c) { return c == "Z" || c == "N" || c == "id"; };
  if (std::all_of(options.channels.begin(), options.channels.end(), plain)) {
    seen.add_channels(options.channels, image);
    return;
  }
  const Lights lights(frames.at(number), input.emission(frames.at(number).frame));
  const NeighbourFrame next{&frames.at(number + 1), &frames.view(number + 1)};
  const NeighbourFrame previous{&frames.at(number - 1), &frames.view(number - 1)};
  add_data_channels({tracer, lights}, frames.view(number), options.channels, next, previous, image);
}

void warp_frame(tools::Tool& tool, const Options& options, tools::SceneInput& input,
                const std::vector<tools::LoadedKey>& keys, tools::FramesOfScene& frames, StaticTree& standing,
                int number) {
  Outputs outputs(options, number);
  tool.stats().phase("evaluate");
  const SceneFrame& frame = frames.at(number, true);
  const tools::KeysOfFrame placed(tool, keys, frames, number);
  tool.stats().phase("build");
  const Tracer tracer(frame, standing);
  tool.stats().phase("look", true);
  const SceneView seen(tracer, frames.view(number));
  tool.stats().phase("flow", true);
  const PixelFlow flow = flow_of_view(seen, {&frames.at(number + 1), &frames.camera(number + 1)},
                                      {&frames.at(number - 1), &frames.camera(number - 1)}, input.time().fps);
  tool.stats().phase("warp", true);
  WarpTarget target{&seen.camera(), &seen.seen(), {}, &flow.speed, {}, {}};
  VisionOptions viewer{vision::display_named("office")};
  viewer.display.pixels_per_degree = kPixelsPerDegree;
  viewer.frames_per_second = input.time().fps;
  target.see_gloss = [&](const GlossInDoubt& doubt) {
    return error_probability(doubt.picture, doubt.error, doubt.counted, flow, viewer);
  };
  target.look = [&](std::span<const RasterPoint> at, FacePoint* points) { seen.look(at, points); };
  if (!has_layer(*keys[0].key, "specular")) {
    target.gloss = seen.gloss();
    if (std::find(target.gloss.begin(), target.gloss.end(), 1) != target.gloss.end())
      tool.warn(keys[0].file +
                ": has no layer specular: everything that mirrors, shines or lets through is masked; render keys "
                "with --channels RGBA,specular,Z,N,id");
  }
  WarpedFrame warped = warp(target, placed.get(), options.warp);

  Image image{frames.view(number).width(), frames.view(number).height(), {}, {}, {}, {}};
  image.text["tempolux:history"] = keys[0].history + tool.history_line(number);
  set_identity(image, identity_of(frame));
  image.numbers["tempolux:frame"] = frame.frame;
  image.numbers["framesPerSecond"] = input.time().fps;
  image.matrices["worldToCamera"] = frames.view(number).world_to_camera();
  image.matrices["worldToNDC"] = frames.view(number).world_to_ndc();
  const Image bare = image;
  tool.stats().phase("data channels", true);
  add_data(options, input, frames, tracer, seen, number, image);
  write(tool, options, outputs, std::move(warped), &flow, std::move(image), bare);
}

/// Warps to a view that is read from a file, without a scene.
void warp_view(tools::Tool& tool, const Options& options, const std::vector<tools::LoadedKey>& keys) {
  Outputs outputs(options, 0);
  const Image other = load_exr(options.view, {.our_names = true});
  tool.depends_on(options.view);
  const FrameCamera camera = camera_of(other, options.view);
  const SeenSurfaces seen = seen_in(other, options.view);
  const formats::Identity identity = identity_in(other);
  const tools::KeysOfFrame placed(keys, camera, identity);
  tool.stats().phase("warp", true);
  WarpedFrame warped = warp({&camera, &seen, {}, nullptr, {}, {}}, placed.get(), options.warp);
  if (std::find(warped.why.begin(), warped.why.end(), 0u) == warped.why.end())
    tool.warn(options.view + ": the keys give none of its pixels; do they show the same scene?");
  Image image{other.width, other.height, {}, {}, other.numbers, other.matrices};
  image.numbers.erase("tempolux:samples");
  image.text["tempolux:history"] = keys[0].history + tool.history_line();
  set_identity(image, identity);
  const Image bare = image;
  for (const Channel& channel : other.channels)
    if (is_data_channel(channel.name)) image.channels.push_back(channel);
  write(tool, options, outputs, std::move(warped), nullptr, std::move(image), bare);
}

void check(const tools::Tool& tool, Options& options, bool several) {
  if (options.scene.empty() == options.view.empty())
    throw InputError(
        "say what to make: a frame of a scene by --scene SCENE --frame F, or what another frame shows by --view FILE");
  if (options.keys.size() > 2) throw InputError("more than two keys; give the one before and the one after the frame");
  tool.check_frame_output(options.output);
  tool.check_patterns({options.flow, options.mask});
  if (!options.view.empty() && (several || !options.flow.empty()))
    throw InputError("--view: shows one frame and knows no others; --frames and --flow need --scene");
  for (const std::string& group : options.channels)
    if (group == "RGBA" || group == "layers" || has_layer_name(group))
      throw InputError("--channels: '" + group +
                       "' is colour, which comes from the keys; name data: Z, N, P, id, albedo, motion");
  check_channels(options.channels);
  if (options.warp.slow_deg_per_s < 0) options.warp.slow_deg_per_s = slow_speed(kPixelsPerDegree);
}

void add_options(tools::Tool& tool, Options& options) {
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
  app.add_option("--channels", options.channels, "data channels besides the keys' colour: Z, N, P, id, albedo, motion")
      ->delimiter(',')
      ->type_name("NAMES")
      ->default_str("Z,N,id");
  tool.number_option("--edge-share", options.warp.edge_share, 0, tools::kNoLimit,
                     "edge pixels are masked if the keys differ by more than this share of the light");
  tool.number_option("--slow", options.warp.slow_deg_per_s, -1, tools::kNoLimit,
                     "moving pixels slower than this are masked, degrees/s; -1: 1.41, half a pixel between two frames");
  tool.choice_option("--compression", options.compression, {"zip", "none"}, "EXR compression");
  tool.output_option(options.output, "EXR file, or a pattern as f.####.exr")->required();
}

}  // namespace

int main(int argc, char** argv) {
  tools::Tool tool("ibr-warp",
                   "Make a frame from key frames by depth, with pixel flow and a mask of the pixels to trace.", argc,
                   argv);
  Options options;
  add_options(tool, options);
  tool.common_options(tools::uses_scene | tools::uses_camera | tools::uses_frames);
  return tool.run([&] {
    tools::keep_freed_memory();
    check(tool, options, tool.common().frames.size() > 1);
    tool.stats().phase("load");
    const std::vector<tools::LoadedKey> keys = tools::load_keys(tool, options.keys);
    if (!options.view.empty()) {
      warp_view(tool, options, keys);
      return tools::exit_ok;
    }
    tools::SceneInput input(tool, options.scene, tools::SceneInput::a_camera);
    tools::FramesOfScene frames(tool, input, keys[0].key->camera().width(), keys[0].key->camera().height());
    StaticTree standing;
    for (const int number : tool.common().frames) {
      std::vector<int> kept{number};
      for (const tools::LoadedKey& key : keys) kept.push_back(key.frame.value_or(number));
      frames.keep(kept);
      warp_frame(tool, options, input, keys, frames, standing, number);
    }
    return tools::exit_ok;
  });
}
