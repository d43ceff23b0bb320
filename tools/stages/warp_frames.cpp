#include "tools/stages/warp_frames.h"

#include <algorithm>
#include <optional>
#include <utility>

#include "lib/aqm/animation_quality.h"
#include "lib/image/frame_identity.h"
#include "lib/image/why_mask.h"
#include "lib/render/data_channels.h"
#include "lib/warp/flow_of_view.h"
#include "lib/warp/warped_image.h"

namespace tempolux::tools {
namespace {

/// The output files of one frame: created before the work, committed together.
struct Outputs {
  Output frame;
  std::optional<Output> flow, mask;
  std::vector<Output> candidates;
  ExrWriteOptions exr;

  Outputs(const WarpFramesOptions& o, int number) : frame(frame_name(o.output, number)), exr(o.exr()) {
    if (!o.flow.empty()) flow.emplace(frame_name(o.flow, number));
    if (!o.mask.empty()) mask.emplace(frame_name(o.mask, number));
    for (std::size_t k = 0; o.warp.separate && k < o.keys.size(); ++k)
      candidates.emplace_back(name_with(frame_name(o.output, number), "_" + std::to_string(k + 1)));
  }
  void commit() {
    frame.commit();
    if (flow) flow->commit();
    if (mask) mask->commit();
    for (Output& candidate : candidates) candidate.commit();
  }
};

void count_work(Tool& tool, const WarpedFrame& warped) {
  Stats& stats = tool.stats();
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

/// Writes a warped frame and the images that were requested with it: candidates, mask and flow. Moves the colours of
/// `warped` into `image`. `bare` is an image without channels that has the size and the attributes of the frame.
void write(Tool& tool, Outputs& outputs, WarpedFrame&& warped, const PixelFlow* flow, Image image, const Image& bare) {
  tool.stats().phase("write");
  add_colour(warped, image);
  save_exr(outputs.frame.temporary_path(), image, outputs.exr);
  for (std::size_t k = 0; k < outputs.candidates.size(); ++k) {
    Image candidate = bare;
    add_candidate(warped, k, candidate);
    save_exr(outputs.candidates[k].temporary_path(), candidate, outputs.exr);
  }
  if (outputs.mask) {
    Image mask = bare;
    mask.add_ids(kWhyChannel).ids = warped.why;
    save_exr(outputs.mask->temporary_path(), mask, outputs.exr);
  }
  if (outputs.flow) {
    Image image_of_flow = bare;
    add_flow_channels(*flow, image_of_flow);
    save_exr(outputs.flow->temporary_path(), image_of_flow, outputs.exr);
  }
  outputs.commit();
  tool.stats().end_phase();
  count_work(tool, warped);
}

/// Warps keys to the frames of a scene.
class WarpRun {
 public:
  WarpRun(Tool& tool, const WarpFramesOptions& options, const std::vector<LoadedKey>& keys)
      : tool_(tool),
        options_(options),
        keys_(keys),
        input_(tool, options.scene, SceneInput::a_camera),
        frames_(tool, input_, keys[0].key->camera().width(), keys[0].key->camera().height()) {}
  void warp_frame(int number);

 private:
  void add_data(const Tracer& tracer, const SceneView& seen, int number, Image& image);

  Tool& tool_;
  const WarpFramesOptions& options_;
  const std::vector<LoadedKey>& keys_;
  SceneInput input_;
  FramesOfScene frames_;
  StaticTree tree_;
};

/// Adds the requested channels besides colour.
void WarpRun::add_data(const Tracer& tracer, const SceneView& seen, int number, Image& image) {
  const auto plain = [](const std::string& c) { return c == "Z" || c == "N" || c == "id"; };
  if (std::all_of(options_.channels.begin(), options_.channels.end(), plain)) {
    seen.add_channels(options_.channels, image);
    return;
  }
  const Lights lights(frames_.at(number), input_.emission(frames_.at(number).frame));
  const NeighbourFrame next{&frames_.at(number + 1), &frames_.view(number + 1)};
  const NeighbourFrame previous{&frames_.at(number - 1), &frames_.view(number - 1)};
  add_data_channels({tracer, lights}, frames_.view(number), options_.channels, next, previous, image);
}

void WarpRun::warp_frame(int number) {
  std::vector<int> kept{number};
  for (const LoadedKey& key : keys_) kept.push_back(key.frame.value_or(number));
  frames_.keep(kept);
  Outputs outputs(options_, number);
  tool_.stats().phase("evaluate");
  const SceneFrame& frame = frames_.at(number, true);
  const KeysOfFrame placed(tool_, keys_, frames_, number);
  tool_.stats().phase("build");
  const Tracer tracer(frame, tree_);
  tool_.stats().phase("look", true);
  const SceneView seen(tracer, frames_.view(number));
  tool_.stats().phase("flow", true);
  const PixelFlow flow = flow_of_view(seen, {&frames_.at(number + 1), &frames_.camera(number + 1)},
                                      {&frames_.at(number - 1), &frames_.camera(number - 1)}, input_.time().fps);
  tool_.stats().phase("warp", true);
  WarpTarget target{&seen.camera(), &seen.seen(), {}, &flow.speed, {}, {}};
  VisionOptions viewer{vision::display_named("office")};
  viewer.display.pixels_per_degree = kPixelsPerDegree;
  viewer.frames_per_second = input_.time().fps;
  target.see_gloss = [&](const GlossInDoubt& doubt) {
    return error_probability(doubt.picture, doubt.error, doubt.counted, flow, viewer);
  };
  target.look = [&](std::span<const RasterPoint> at, FacePoint* points) { seen.look(at, points); };
  if (!has_layer(*keys_[0].key, "specular")) {
    target.gloss = seen.gloss();
    if (std::find(target.gloss.begin(), target.gloss.end(), 1) != target.gloss.end())
      tool_.warn(keys_[0].file +
                 ": has no layer specular: everything that mirrors, shines or lets through is masked; render keys "
                 "with --channels RGBA,specular,Z,N,id");
  }
  WarpedFrame warped = warp(target, placed.get(), options_.warp);

  Image image{frames_.view(number).width(), frames_.view(number).height(), {}, {}, {}, {}};
  describe_frame(image, identity_of(frame), frame.frame, input_.time().fps,
                 keys_[0].history + tool_.history_line(number),
                 {frames_.view(number).world_to_camera(), frames_.view(number).world_to_ndc()});
  const Image bare = image;
  tool_.stats().phase("data channels", true);
  add_data(tracer, seen, number, image);
  write(tool_, outputs, std::move(warped), &flow, std::move(image), bare);
}

}  // namespace

void warp_frames(Tool& tool, const WarpFramesOptions& options, const std::vector<LoadedKey>& keys) {
  WarpRun run(tool, options, keys);
  for (const int number : tool.common().frames) run.warp_frame(number);
}

void warp_view(Tool& tool, const WarpFramesOptions& options, const std::vector<LoadedKey>& keys) {
  Outputs outputs(options, 0);
  const Image other = load_exr(options.view, {.our_names = true});
  tool.depends_on(options.view);
  const FrameCamera camera = camera_of(other, options.view);
  const SeenSurfaces seen = seen_in(other, options.view);
  const formats::Identity identity = identity_in(other);
  const KeysOfFrame placed(keys, camera, identity);
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
  write(tool, outputs, std::move(warped), nullptr, std::move(image), bare);
}

}  // namespace tempolux::tools
