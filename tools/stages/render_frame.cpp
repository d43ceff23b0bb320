#include "tools/stages/render_frame.h"

#include <algorithm>
#include <memory>
#include <optional>
#include <utility>

#include "formats/error.h"
#include "lib/core/random.h"
#include "lib/image/channel_groups.h"
#include "lib/image/exr_io.h"
#include "lib/pilot/hidden_light.h"
#include "lib/render/data_channels.h"
#include "lib/render/feature_means.h"
#include "lib/render/matte_channels.h"
#include "lib/render/shutter.h"
#include "lib/render/still_pixels.h"
#include "lib/scene/light_units.h"
#include "tools/stages/base_frame.h"
#include "tools/stages/frame_account.h"
#include "tools/stages/frame_audit.h"
#include "tools/stages/frame_output.h"
#include "tools/stages/lit_frame.h"

namespace tempolux::tools {
namespace {

/// The neighbouring frames that motion needs; empty if it is not requested.
struct MotionFrame {
  std::optional<SceneFrame> frame;
  std::optional<CameraView> view;
  MotionFrame(SceneInput& input, const RenderOptions& options, int camera, int number) {
    if (!asked(options.channels, "motion")) return;
    frame = input.at(number, false);
    view.emplace(frame->camera(camera), frame->origin, options.width, options.height);
  }
  NeighbourFrame get() const { return {frame ? &*frame : nullptr, view ? &*view : nullptr}; }
};

void count_work(Tool& tool, const RenderedFrame& rendered, const Tracer& tracer) {
  Stats& stats = tool.stats();
  stats.count("camera_rays", double(rendered.rays.camera));
  stats.count("bounce_rays", double(rendered.rays.bounce));
  stats.count("shadow_rays", double(rendered.rays.shadow));
  stats.count("noise_rays",
              double(rendered.noise_rays.camera + rendered.noise_rays.bounce + rendered.noise_rays.shadow));
  stats.count("lookups", double(rendered.rays.lookups));
  stats.count("refused_rays", double(tracer.refused_ray_count()));
  stats.count("gathered_in_pixels", double(rendered.rays.gathered));
  stats.count("points_read", double(rendered.rays.points_read));
  stats.set("samples_per_pixel", rendered.samples_per_pixel);
  stats.set("mean_radiance", rendered.mean_radiance);
  stats.set("spread", rendered.spread);
}

/// Options of the frame `number`, without mask and known light.
FrameOptions options_of(Tool& tool, const RenderOptions& options, int number) {
  const bool is_reference = options.integrator == "path";
  FrameOptions frame = options.frame;
  frame.seed = tool.common().seed_for_frame(number);
  // A reference gets other random numbers than a frame. With the same numbers both would have the same noise, and the
  // frame's error would look too small.
  if (is_reference) frame.seed = mix64(frame.seed ^ 0x7265666572656e63ull);
  frame.spread_outliers = !options.keep_outliers && !is_reference;
  frame.camera_samples = asked(options.channels, "cryptomatte");
  frame.progress = tool.progress_sink();
  return frame;
}

/// The moments of the camera's shutter; nullptr if nothing is blurred. Stored light belongs to the frame's time, so it
/// can be read only where this is the middle of the shutter (centre_shutter.h).
std::unique_ptr<const Shutter> open_shutter(Tool& tool, const RenderOptions& options, const ShutterInput& input) {
  const Camera& camera = input.view.camera().camera;
  if (!(camera.shutter_frames > 0)) return nullptr;
  tool.stats().phase("shutter", true);
  std::unique_ptr<const Shutter> shutter = Shutter::of(input);
  if (!shutter) return nullptr;
  if (!options.traces_paths() && camera.shutter != Camera::Shutter::centre)
    throw InputError(
        "--shutter: photons, points and records belong to the middle of the shutter, which lies elsewhere in each "
        "frame because shutter_frames changes: give --shutter-open centre, or --shutter DEG for all frames (make: "
        "SHUTTER_OPEN, SHUTTER)");
  tool.stats().count("shutter_moments", double(shutter->moment_count()));
  tool.stats().set("shutter_motion_px", shutter->motion_px());
  return shutter;
}

/// Decides which pixels keep those of the other moment. All others become the mask of `options`.
StillPixels keep_pixels(Tool& tool, const LitFrame& now, const StillMoment& before, FrameOptions& options) {
  StillPixels still =
      still_pixels(now.sampler(options.seed), before.moment().sampler(options.seed), before.image(), options);
  options.mask = still.anew;
  tool.stats().set("sampled_anew", still.share_anew());
  tool.stats().set("still.work", still.work);
  tool.stats().set("still.samples_per_pixel", still.samples_per_pixel);
  return still;
}

void render(Tool& tool, SceneInput& input, const RenderOptions& options, int number, StaticTree& tree) {
  FrameOutputs outputs(frame_name(options.output, number), options.frame.halves);
  tool.stats().phase("evaluate");
  const int camera = input.scene().camera_node(tool.common().camera);
  LitFrame lit(input, number, camera, options.width, options.height);
  const SceneFrame& frame = lit.frame();
  const CameraView& view = lit.view();
  const MotionFrame next(input, options, camera, number + 1), previous(input, options, camera, number - 1);
  FrameOptions frame_options = options_of(tool, options, number);
  BaseFrame base;
  if (!options.mask.empty()) {
    const Picture picture{options.width, options.height, {view.world_to_camera(), view.world_to_ndc()}};
    base = read_base_frame(tool, frame_name(options.mask, number), frame_name(options.base, number), frame, picture);
    frame_options.mask = base.mask;
  }
  tool.stats().phase("build");
  const bool is_reference = options.integrator == "path";
  lit.build(input, tree, is_reference);
  const RenderScene& scene = lit.scene();
  std::optional<StillMoment> before;
  if (!options.still.frame.empty()) {
    tool.stats().phase("still moment");
    before.emplace(tool, input, options.still, view, frame_options.seed);
    lit.guide_sky(before->moment().lights().guide());  // both moments must draw the same directions
  } else if (!is_reference) {
    lit.guide_sky();
  }
  lit.read_light(tool, options.light, tool.common().seed_for_frame(number));

  const std::unique_ptr<const Shutter> shutter =
      open_shutter(tool, options, {input.scene(), input.time(), camera, scene, view});
  frame_options.shutter = shutter.get();
  // Light paths know the middle of the shutter alone.
  if (!shutter && options.light_paths > 0 && light_paths_find(frame, input.emission(number)))
    lit.leave_out_hidden_light();
  tool.stats().phase("render", true);
  if (!is_reference) frame_options.known = &lit.light().get();
  Image image{options.width, options.height, {}, {}, {}, {}};
  std::vector<std::uint8_t> edges = add_coverage_channel(scene, view, options.channels, image);
  const bool blurred = view.has_lens() || shutter;
  if (!edges.empty() && blurred) edges = soft_edges(scene, view, shutter.get());
  if (asked(options.channels, "halves")) frame_options.edges = std::move(edges);
  StillPixels still;
  if (before) still = keep_pixels(tool, lit, *before, frame_options);
  RenderedFrame rendered = render_frame(scene, view, frame_options);
  if (before) add_noise_of_kept(before->image(), still, rendered.noise);

  const AuditedFrame made{scene, input.emission(frame.frame), view, frame_options, rendered, options.light_paths};
  add_light_without_paths(tool, options, made, rendered);
  if (number == tool.common().frames.front()) warn_of_missing_light(tool, made);
  bool unbiased = false;
  const std::vector<AuditEntry> audited = audit(tool, options, made, unbiased);
  std::map<std::string, double> account = account_of(rendered, audited);
  const LitBy lit_by = options.light.meshirrad.empty() ? LitBy::points : LitBy::texture;
  if (lit_by == LitBy::texture && !audited.empty()) {
    account["audit.texture"] = 1;
    tool.stats().set("audit.texture", 1);
  }
  if (unbiased) {
    account["audit.unbiased"] = 1;
    tool.stats().set("audit.unbiased", 1);
    tool.say("audit: no bias, as camera paths find all light");
  }
  tool.stats().phase("data channels", true);
  add_data_channels(scene, view, options.channels, next.get(), previous.get(), image);
  const auto sharp_edges = blurred ? std::span<const std::uint8_t>{} : frame_options.edges;
  if (blurred || !sharp_edges.empty())
    add_feature_means(scene, view, shutter.get(), sharp_edges, options.channels, image);
  add_seen_channels(scene, view, options.channels, image);
  add_matte_channels(scene, view, frame_options, rendered, MatteNames(input.scene()), options.channels, image);
  add_influence_channels(scene, view, lit.light().get().localised, options.channels, image);
  tool.stats().phase("write");
  const FrameDescription description{identity_of(frame),
                                     lit.light().history() + tool.history_line(number),
                                     frame.frame,
                                     input.time().fps,
                                     {view.world_to_camera(), view.world_to_ndc()},
                                     account,
                                     input.scene().object_names,
                                     options.channels,
                                     options.exr()};
  outputs.write(rendered, std::move(image), description,
                before ? KeptPixels{still.anew, before->image(), &still} : KeptPixels{base.mask, base.base});
  tool.stats().end_phase();
  rendered.rays += still.rays;
  rendered.noise_rays += still.noise_rays;
  count_work(tool, rendered, lit.tracer());
  report_account(tool, rendered, audited, frame_options, input.scene().object_names, lit_by);
}

/// Only for frames by path tracing: the tools that made photons or a cache have given this warning already.
void warn_of_light_units(Tool& tool, const Scene& scene) {
  if (const std::string doubt = doubt_of_light_units(scene); tool.common().light_units == "raw" && !doubt.empty())
    tool.warn(doubt);
}

/// A scene without light may be intended (unlit materials, depth only), but a black frame needs an explanation.
void warn_of_darkness(Tool& tool, const Scene& scene) {
  if (std::ranges::any_of(scene.materials, &Material::unlit)) return;
  try {
    require_lights(scene);
  } catch (const InputError& error) { tool.warn(error.what()); }
}

}  // namespace

void render_frames(Tool& tool, SceneInput& input, const RenderOptions& options) {
  warn_of_darkness(tool, input.scene());
  if (options.integrator == "path") warn_of_light_units(tool, input.scene());
  StaticTree tree;
  for (const int frame : tool.common().frames) render(tool, input, options, frame, tree);
}

}  // namespace tempolux::tools
