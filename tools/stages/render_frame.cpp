#include "tools/stages/render_frame.h"

#include <algorithm>
#include <memory>
#include <optional>

#include "formats/error.h"
#include "lib/core/formatted.h"
#include "lib/core/random.h"
#include "lib/image/channel_groups.h"
#include "lib/image/exr_io.h"
#include "lib/material/smooth_material.h"
#include "lib/audit/audit.h"
#include "lib/render/blurred_albedo.h"
#include "lib/render/data_channels.h"
#include "lib/render/shutter.h"
#include "lib/render/still_pixels.h"
#include "lib/pilot/hidden_light.h"
#include "lib/pilot/seen_spheres.h"
#include "lib/scene/light_units.h"
#include "tools/stages/base_frame.h"
#include "tools/stages/frame_account.h"
#include "tools/stages/frame_output.h"

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

/// A rendered frame, with the scene, the lights, the view and the options that it was rendered from.
struct Shot {
  const RenderScene& scene;
  const EmissionTable& emission;
  const CameraView& view;
  const FrameOptions& options;
  const RenderedFrame& rendered;
  std::uint64_t light_paths = 0;  ///< of add_light_without_paths

  mutable std::optional<double> hidden = {};  ///< the result of hidden_light(), once it is known

  /// These lights, with distant light aimed at what the camera sees.
  Lights aimed(Lights::Which which) const { return aimed_lights(scene.tracer, emission, view, which); }
  /// Share of the picture that point, spot and sun lights bring by way of mirrors and smooth glass (hidden_share()).
  /// Photons measure the share at the first call.
  double hidden_light() const {
    if (!hidden)
      hidden = hidden_share(scene, aimed(Lights::Which::punctual), view, mean_to_white(rendered.mean.pixels, {}));
    return *hidden;
  }
};

/// Warns if the frame lacks light of point, spot and sun lights that mirrors or smooth glass send on: no camera path
/// finds such light. A frame by path tracing is warned of in any case. For other frames photons measure the missing
/// light, and a share that an audit tolerates gives no warning.
void warn_of_missing_light(Tool& tool, const Shot& shot) {
  const SceneFrame& frame = shot.scene.frame();
  const KnownLight* const known = shot.options.known;
  if (!may_hide_light(frame) || (known && known->has_caustic()) || shot.light_paths > 0) return;
  const auto shines =
      std::ranges::find_if(frame.lights, [](const PlacedLight& l) { return max_component(l.light.intensity) > 0; });
  std::string share;
  if (known) {
    if (!(shot.hidden_light() > 0)) return;
    share = formatted(" (%.2g %% of the picture)", 100 * shot.hidden_light());
  }
  const std::string &material = frame.materials[first_smooth_material(frame)].name, &light = shines->light.name;
  tool.warn(frame.scene->path + ": materials" + (material.empty() ? "" : " \"" + material + "\"") +
            ": what point, spot and sun lights send by way of mirrors and smooth glass is missing" + share +
            (light.empty() ? "" : ", as that of light \"" + light + "\"") +
            ": no path finds it; photons do (--photons; make: INDIRECT=gather or records)");
}

/// Measures the bias of the frame's layers, with photons or camera paths of its own:
/// - Light of lamps: photons, because few camera paths meet a bright spot close to a lamp. Photons are also looked at
///   in mirrors and glass (SpecularHits).
/// - Light of sun and sky: camera paths, because few photons of sun and sky arrive in view.
/// - All light if the scene has a sun, maybe in a map of light, and a mirror or smooth glass that is no pane or plate:
///   photons, because no camera path meets a sun via a smooth surface.
/// If only camera paths are needed and the frame was rendered by paths, nothing is measured and `unbiased` becomes
/// true.
std::vector<AuditEntry> audit(Tool& tool, const RenderOptions& options, const Shot& shot, bool& unbiased) {
  if (!(options.audit > 0)) return {};
  const RenderScene& scene = shot.scene;
  const CameraView& view = shot.view;
  const EnvironmentLight* const environment = shot.emission.environment.get();
  const auto is_plate = [&](std::uint32_t surface) { return scene.tracer.is_plate(surface); };
  const bool suns = scene.lights.has_suns() || (environment && environment->has_sun()),
             hidden = suns && (first_smooth_material(scene.frame(), false, is_plate) != kNone ||
                               (may_hide_light(scene.frame()) && shot.hidden_light() > 0)),
             paths = scene.lights.has_distant() && !hidden, photons = hidden || scene.lights.has_placed(),
             specular = photons && !options.traces_paths() && !scene.frame().media;
  unbiased = paths && !photons && options.traces_paths();
  if (unbiased) return {};
  tool.stats().phase("audit", true);
  Image ids{view.width(), view.height(), {}, {}, {}, {}};
  add_data_channels(scene, view, {"id"}, {}, {}, ids);
  const Tracer& tracer = scene.tracer;
  AuditEffort effort = audit_effort(options.audit, shot.rendered.rays, photons, paths, specular,
                                    mix64(shot.options.seed + std::uint64_t(tracer.frame().frame)));
  const auto measure = [&] {
    FrameAudit audit(view, shot.rendered, ids.channels.front().ids, shot.options.mask, scene.camera_inside);
    std::optional<SpecularHits> hits;
    if (specular && photons) hits.emplace(scene, view, shot.options.mask, effort.specular_paths, ~effort.seed);
    if (photons)
      audit.add_photons(tracer, shot.aimed(hidden ? Lights::Which::all : Lights::Which::placed), effort,
                        hits ? &*hits : nullptr);
    if (paths) {
      const Lights distant(tracer.frame(), shot.emission, Lights::Which::distant);
      audit.add_paths({tracer, distant, distant.has_suns(), scene.camera_inside}, effort);
    }
    return audit.entries();
  };
  const std::vector<AuditEntry> entries = measure();
  const auto warns = [](const AuditEntry& entry) {
    return entry.part == "picture" && entry.layer != Layer::direct && is_biased(entry);
  };
  if (std::ranges::none_of(entries, warns)) return entries;
  // In one of a hundred unbiased frames chance alone gives such a figure. A larger audit with another seed decides.
  effort.photon_paths *= kAuditAgain, effort.eye_paths *= kAuditAgain, effort.specular_paths *= kAuditAgain;
  effort.seed = mix64(effort.seed);
  return measure();
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
  frame.progress = tool.progress_sink();
  return frame;
}

/// --light-paths: adds the light that no camera path finds to the picture, or to both halves and their mean.
void add_light_without_paths(Tool& tool, const RenderOptions& options, const Shot& shot, RenderedFrame& rendered) {
  if (options.light_paths == 0 || !may_hide_light(shot.scene.frame())) return;
  tool.stats().phase("light paths", true);
  tool.say("light paths: what mirrors, glass and gloss show of their light is still missing (layer specular)");
  const Lights lights = shot.aimed(Lights::Which::punctual);
  const auto add = [&](std::uint64_t paths, std::uint64_t number, LayerImage& picture) {
    const std::uint64_t seed = mix64(shot.options.seed ^ (0x6c69676874ull << 8 | number));
    add_hidden_light(shot.scene, lights, shot.view, paths, seed, picture);
  };
  if (rendered.half[0].pixels.empty()) return add(options.light_paths, 0, rendered.mean);
  for (const std::size_t h : {0u, 1u}) {
    const std::vector<Layers> before = rendered.half[h].pixels;
    add(options.light_paths / 2, h, rendered.half[h]);
    for (std::size_t p = 0; p < before.size(); ++p)
      for (std::size_t l = 0; l < kLayerCount; ++l)
        rendered.mean.pixels[p].value[l] += (rendered.half[h].pixels[p].value[l] - before[p].value[l]) * 0.5f;
  }
}

/// The moments of the camera's shutter; nullptr if nothing is blurred. Stored light belongs to the frame's time, so it
/// can be read only where this is the middle of the shutter.
std::unique_ptr<const Shutter> open_shutter(Tool& tool, const RenderOptions& options, const ShutterInput& input) {
  const Camera& camera = input.view.camera().camera;
  if (!(camera.shutter_frames > 0)) return nullptr;
  tool.stats().phase("shutter", true);
  std::unique_ptr<const Shutter> shutter = Shutter::of(input);
  if (!shutter) return nullptr;
  if (!options.traces_paths() && camera.shutter != Camera::Shutter::centre)
    throw InputError(
        "--shutter: photons, points and records belong to the frame's time, which must lie in the middle of the "
        "shutter: give --shutter-open centre, or --shutter 0 for a sharp picture (make: SHUTTER_OPEN, SHUTTER)");
  tool.stats().count("shutter_moments", double(shutter->moment_count()));
  tool.stats().set("shutter_motion_px", shutter->motion_px());
  return shutter;
}

/// Decides which pixels keep those of the other moment. All others become the mask of `options`.
StillPixels keep_pixels(Tool& tool, const LitFrame& now, const StillMoment& before, FrameOptions& options) {
  StillPixels still = still_pixels(now.sampler(options.seed), before.moment().sampler(options.seed), options);
  options.mask = still.anew;
  tool.stats().set("sampled_anew", still.share_anew());
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
  tool.stats().phase("render", true);
  if (!is_reference) frame_options.known = &lit.light().get();
  Image image{options.width, options.height, {}, {}, {}, {}};
  std::vector<std::uint8_t> edges = add_coverage_channel(scene, view, options.channels, image);
  if (asked(options.channels, "halves")) frame_options.edges = std::move(edges);
  StillPixels still;
  if (before) still = keep_pixels(tool, lit, *before, frame_options);
  RenderedFrame rendered = render_frame(scene, view, frame_options);
  if (before) add_noise_of_kept(before->image(), still.share_anew(), rendered.noise);

  const Shot shot{scene, input.emission(frame.frame), view, frame_options, rendered, options.light_paths};
  add_light_without_paths(tool, options, shot, rendered);
  if (number == tool.common().frames.front()) warn_of_missing_light(tool, shot);
  bool unbiased = false;
  const std::vector<AuditEntry> audited = audit(tool, options, shot, unbiased);
  std::map<std::string, double> account = account_of(rendered, audited);
  if (unbiased) {
    account["audit.unbiased"] = 1;
    tool.stats().set("audit.unbiased", 1);
    tool.say("audit: no bias, as camera paths find all light");
  }
  tool.stats().phase("data channels", true);
  add_data_channels(scene, view, options.channels, next.get(), previous.get(), image);
  if (view.has_lens() || shutter) blur_albedo(scene, view, shutter.get(), image);
  add_seen_channels(scene, view, options.channels, image);
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
  outputs.write(rendered, image, description,
                before ? KeptPixels{still.anew, before->image(), &still} : KeptPixels{base.mask, base.base});
  tool.stats().end_phase();
  rendered.rays += still.rays;
  count_work(tool, rendered, lit.tracer());
  report_account(tool, rendered, audited, frame_options, input.scene().object_names);
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

void check_still(const RenderOptions& options) {
  const auto both = [&](std::string IndirectLightOptions::*file) {
    return (options.light.*file).empty() == (options.still.light.*file).empty();
  };
  const bool files = !options.still.light.photons.empty() || !options.still.light.irradcache.empty() ||
                     !options.still.light.points.empty();
  if (options.still.frame.empty()) {
    if (files) throw InputError("--still-photons, --still-irradcache, --still-points: name the frame with --still");
    return;
  }
  if (!options.base.empty() || options.frame.halves || options.half_float)
    throw InputError("--still: with --base, --halves or --half pixels would not be those of the frame; leave out one");
  if (options.integrator == "path" || !options.light.meshirrad.empty() || !(options.pixel_error != 0))
    throw InputError(
        "--still: needs --pixel-error, which decides what is sampled anew, and no --integrator path or --meshirrad");
  for (const auto file : {&IndirectLightOptions::photons, &IndirectLightOptions::irradcache,
                          &IndirectLightOptions::points, &IndirectLightOptions::high})
    if (!both(file))
      throw InputError(
          "--still: both moments need the same kinds of light files: give each of --photons, --irradcache, --points, "
          "--high together with the --still- option of its name");
}

void check(const Tool& tool, RenderOptions& options) {
  tool.check_frame_output(options.output);
  for (const char* other : {".png", ".jpg", ".jpeg", ".hdr", ".tif", ".tiff", ".bmp", ".ppm", ".pfm", ".webp"})
    if (options.output.ends_with(other))
      throw InputError("--output " + options.output +
                       ": a frame is OpenEXR; name it f.exr, then tempolux-info --png f.png f.exr");
  if (options.integrator == "photons" && !(options.light.irradcache.empty() && options.light.points.empty()))
    throw InputError("--integrator photons reads no cache and no points; leave them out, or the integrator");
  if (!options.light.meshirrad.empty() &&
      !(options.light.irradcache.empty() && options.light.points.empty() && options.integrator == "auto"))
    throw InputError(
        "--meshirrad and --irradcache, --points or --integrator: a light texture is all indirect light by itself; "
        "leave out one");
  if (options.integrator == "photons" && options.light.photons.empty())
    throw InputError("--integrator photons: name the photon map with --photons FILE");
  if (!options.light.dynamic.empty() && options.light.photons.empty())
    throw InputError(
        "--dynamic: what movers change is nothing alone; name the segment's static map with --photons FILE");
  if (!options.light.high.empty() && options.light.points.empty() &&
      (options.light.photons.empty() || !options.light.dynamic.empty()))
    throw InputError("--high: name the low part of the same map with --points FILE or --photons FILE");
  if (!options.light.high.empty() && !options.light.points.empty() && !options.light.irradcache.empty())
    throw InputError(
        "--high: records of --irradcache hold the high part; give irradcache-build records --high, and the whole "
        "points here");
  if (options.integrator == "cache" && options.light.irradcache.empty())
    throw InputError("--integrator cache: name the cache with --irradcache FILE");
  if (options.integrator == "path" && !options.traces_paths())
    throw InputError("--integrator path reads no photons and no cache; leave them out, or the integrator");
  if (options.light_paths > 0 && options.integrator != "path")
    throw InputError("--light-paths: only for --integrator path; photons find this light");
  if (options.light_paths > 0 && !options.base.empty())
    throw InputError("--light-paths: adds light to all pixels, also to those of --base; leave out one");
  options.light.photons_alone = options.integrator == "photons";
  options.light.influence.high *= options.light.influence.low / InfluenceThresholds{}.low;  // keeps ratio()
  if (options.mask.empty() != options.base.empty()) throw InputError("--mask and --base need each other");
  check_still(options);
  if (!options.base.empty() && options.frame.halves)
    throw InputError(
        "--halves: pixels of --base are the same in both, so that they are not independent; leave out one");
  if (!options.base.empty() && options.half_float)
    throw InputError("--half: would round the pixels of --base, which are kept bit for bit; leave out one");
  if (options.pixel_error < 0) options.frame.pixel_error = options.traces_paths() ? 0 : options.pixel_error_of_files;
  else options.frame.pixel_error = options.pixel_error;
  const bool halves = options.frame.halves;
  if (halves && options.frame.samples % 2 != 0) throw InputError("--spp: halves need an even number of samples");
  if (halves && options.pixel_error > 0)
    throw InputError("--pixel-error: halves take the same samples everywhere; leave out one");
  if (halves && options.frame.seen_error > 0)
    throw InputError("--seen-error: halves take the same samples everywhere; leave out one");
  if (options.frame.seen_error > 0 && options.pixel_error < 0)
    options.frame.pixel_error = pixel_error_of_codes(options.frame.seen_error);
  if (options.frame.seen_error > 0 && !(options.frame.pixel_error > 0))
    throw InputError("--pixel-error 0: --seen-error needs it to share samples out; leave it out");
  if (halves) options.frame.pixel_error = 0;
  options.frame.sample_halves = wants_sample_halves(options.channels);
  check_channels(options.channels);
}

void render_frames(Tool& tool, SceneInput& input, const RenderOptions& options) {
  warn_of_darkness(tool, input.scene());
  if (options.integrator == "path") warn_of_light_units(tool, input.scene());
  StaticTree tree;
  for (const int frame : tool.common().frames) render(tool, input, options, frame, tree);
}

}  // namespace tempolux::tools
