// frame-render -- trace the pixels of a frame: by path tracing, from a photon map, or from an irradiance cache.
//
//     frame-render room.glb --frame 12 --size 640x360 --spp 256 --halves -o ref.0012.exr
//     frame-render room.glb --frame 12 --size 640x360 --photons p.0012.photons -o f.0012.exr
//     frame-render room.glb --frame 12 --size 640x360 --irradcache c.0012.irradcache --photons p.0012.photons
//                  -o f.0012.exr
//
// Channels and attributes: formats/frames/frames.md.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <optional>
#include <string>
#include <vector>

#include "formats/error.h"
#include "lib/core/random.h"
#include "lib/image/exr_io.h"
#include "lib/material/smooth_material.h"
#include "lib/render/audit.h"
#include "lib/render/coverage_channel.h"
#include "lib/render/frame_renderer.h"
#include "lib/render/influence_channels.h"
#include "lib/render/seen_channels.h"
#include "lib/render/seen_spheres.h"
#include "lib/scene/light_units.h"
#include "tools/common/option_words.h"
#include "tools/common/scene_input.h"
#include "tools/common/tool_main.h"
#include "tools/stages/base_frame.h"
#include "tools/stages/frame_account.h"
#include "tools/stages/frame_output.h"
#include "tools/stages/indirect_light.h"

using namespace tempolux;

namespace {

struct Options {
  std::string scene, output, integrator = "auto", compression = "zip", mask, base;
  std::vector<std::string> channels{"RGBA", "Z", "N", "id"};
  FrameOptions frame;
  tools::IndirectLightOptions light;
  double pixel_error = -1;
  bool half_float = false, keep_outliers = false;
  int width = 640, height = 360;
  double audit = 0;  ///< share of the frame's camera rays

  bool traces_paths() const {
    return light.photons.empty() && light.irradcache.empty() && light.points.empty() && light.meshirrad.empty();
  }
};

/// The neighbouring frames that motion needs; empty if it is not requested.
struct MotionFrame {
  std::optional<SceneFrame> frame;
  std::optional<CameraView> view;
  MotionFrame(tools::SceneInput& input, const Options& options, int camera, int number) {
    if (std::find(options.channels.begin(), options.channels.end(), "motion") == options.channels.end()) return;
    frame = input.at(number, false);
    view.emplace(frame->camera(camera), frame->origin, options.width, options.height);
  }
  NeighbourFrame get() const { return {frame ? &*frame : nullptr, view ? &*view : nullptr}; }
};

void count_work(tools::Tool& tool, const RenderedFrame& rendered, const Tracer& tracer) {
  tools::Stats& stats = tool.stats();
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
  if (rendered.own_rmse >= 0) stats.set("own_rmse", rendered.own_rmse);
}

/// Warns if path tracing cannot find some light of the scene: no path hits a light without extent after a mirror, so
/// the reference would lack the light.
void warn_of_missing_light(tools::Tool& tool, const SceneFrame& frame) {
  const std::uint32_t smooth = frame.lights.empty() ? kNone : first_smooth_material(frame);
  if (smooth == kNone) return;
  const std::string& name = frame.materials[smooth].name;
  tool.warn(frame.scene->path + ": materials" + (name.empty() ? "" : " \"" + name + "\"") +
            ": what point, spot and sun lights send by way of mirrors and smooth glass is missing: no path finds it; "
            "photons do (--photons)");
}

/// Measures the bias of the frame's layers. Half of the effort is photons and half is camera paths, unless paths lack
/// light that the frame has.
std::vector<AuditEntry> audit(tools::Tool& tool, const Options& options, const RenderScene& scene,
                              const EmissionTable& table, const CameraView& view, const FrameOptions& frame_options,
                              const RenderedFrame& rendered) {
  if (!(options.audit > 0)) return {};
  tool.stats().phase("audit", true);
  Image ids{view.width(), view.height(), {}, {}, {}, {}};
  add_data_channels(scene, view, {"id"}, {}, {}, ids);
  FrameAudit audit(view, rendered, ids.channels.front().ids, frame_options.mask);
  const AuditEffort effort =
      audit_effort(options.audit, rendered.rays, mix64(frame_options.seed + std::uint64_t(scene.frame().frame)));
  audit.add_photons(scene.tracer, aimed_lights(scene.tracer, table, view), effort);
  if (frame_options.known && (scene.frame().lights.empty() || first_smooth_material(scene.frame()) == kNone))
    audit.add_paths(scene, frame_options, effort);
  return audit.entries();
}

/// Options of the frame `number`, without mask and known light.
FrameOptions options_of(tools::Tool& tool, const Options& options, int number) {
  const bool yardstick = options.integrator == "path";
  FrameOptions frame = options.frame;
  frame.seed = tool.common().seed_for_frame(number);
  // With the frame's own random numbers a reference would have the frame's noise, and the frame's error would seem too
  // small.
  if (yardstick) frame.seed = mix64(frame.seed ^ 0x7265666572656e63ull);
  frame.spread_outliers = !options.keep_outliers && !yardstick;
  frame.progress = [&tool](double fraction) { tool.progress(fraction); };
  return frame;
}

void render(tools::Tool& tool, tools::SceneInput& input, const Options& options, int number, StaticTree& standing) {
  tools::FrameOutputs outputs(tools::frame_name(options.output, number), options.frame.halves);
  tool.stats().phase("evaluate");
  const SceneFrame frame = input.at(number);
  if (options.integrator == "path" && number == tool.common().frames.front()) {
    warn_of_missing_light(tool, frame);
    // With photons or a cache, the tools that made them have given this warning.
    if (const std::string doubt = doubt_of_light_units(input.scene());
        tool.common().light_units == "raw" && !doubt.empty())
      tool.warn(doubt);
  }
  const int camera = input.scene().camera_node(tool.common().camera);
  const CameraView view(frame.camera(camera), frame.origin, options.width, options.height);
  const MotionFrame next(input, options, camera, number + 1), previous(input, options, camera, number - 1);
  FrameOptions frame_options = options_of(tool, options, number);
  tools::BaseFrame base;
  if (!options.mask.empty()) {
    const tools::Picture picture{options.width, options.height, view.world_to_camera(), view.world_to_ndc()};
    base = tools::read_base_frame(tool, tools::frame_name(options.mask, number),
                                  tools::frame_name(options.base, number), frame, picture);
    frame_options.mask = base.mask;
  }
  tool.stats().phase("build");
  const Tracer tracer(frame, standing);
  const Lights lights(frame, input.emission(frame.frame));
  const bool yardstick = options.integrator == "path";
  const RenderScene scene{tracer, lights, !yardstick && lights.has_suns()};
  const tools::IndirectLight light(tool, options.light, tracer, lights, tool.common().seed_for_frame(number), number);

  tool.stats().phase("render", true);
  if (!yardstick) frame_options.known = &light.get();
  const RenderedFrame rendered = render_frame(scene, view, frame_options);

  const std::vector<AuditEntry> audited =
      audit(tool, options, scene, input.emission(frame.frame), view, frame_options, rendered);
  tool.stats().phase("data channels", true);
  Image image{options.width, options.height, {}, {}, {}, {}};
  add_data_channels(scene, view, options.channels, next.get(), previous.get(), image);
  add_coverage_channel(scene, view, options.channels, image);
  add_seen_channels(scene, view, options.channels, image);
  add_influence_channels(scene, view, light.get().localised, options.channels, image);
  tool.stats().phase("write");
  const ExrWriteOptions exr{options.half_float, options.compression == "none" ? ExrWriteOptions::Compression::none
                                                                              : ExrWriteOptions::Compression::zip};
  const tools::FrameDescription description{identity_of(frame),
                                            light.history() + tool.history_line(number),
                                            frame.frame,
                                            input.time().fps,
                                            view.world_to_camera(),
                                            view.world_to_ndc(),
                                            tools::account_of(rendered, audited),
                                            input.scene().object_names};
  outputs.write(rendered, image, options.channels, description, exr, base.mask, base.base);
  tool.stats().end_phase();
  count_work(tool, rendered, tracer);
  tools::report_account(tool, rendered, audited, frame_options, input.scene().object_names);
}

/// A scene without light may be intended (unlit materials, depth only), but a black frame needs an explanation.
void warn_of_darkness(tools::Tool& tool, const Scene& scene) {
  if (std::ranges::any_of(scene.materials, &Material::unlit)) return;
  try {
    require_lights(scene);
  } catch (const InputError& error) { tool.warn(error.what()); }
}

void check(const tools::Tool& tool, Options& options) {
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
  options.light.photons_alone = options.integrator == "photons";
  options.light.influence.high *= options.light.influence.low / InfluenceThresholds{}.low;  // the same ratio
  if (options.mask.empty() != options.base.empty()) throw InputError("--mask and --base need each other");
  if (!options.base.empty() && options.frame.halves)
    throw InputError(
        "--halves: pixels of --base are the same in both, so that they are not independent; leave out one");
  if (!options.base.empty() && options.half_float)
    throw InputError("--half: would round the pixels of --base, which are kept bit for bit; leave out one");
  if (options.pixel_error < 0) options.frame.pixel_error = options.traces_paths() ? 0 : 0.01;
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

void add_light_options(tools::Tool& tool, Options& options) {
  CLI::App& app = tool.app();
  tool.choice_option(
      "--integrator", options.integrator, {"auto", "path", "photons", "cache"},
      "path: unbiased path tracing; photons, cache: indirect light from --photons or --irradcache; auto: by "
      "the given files");
  tool.file_option("--photons", options.light.photons,
                   ".photons file, or a pattern: indirect and caustic light; with --irradcache, or if the map has only "
                   "caustic photons, caustic light alone");
  tool.file_option("--dynamic", options.light.dynamic,
                   ".photons file of the frame, photon-trace --map dynamic, or a pattern: --photons is then the "
                   "segment's static map");
  tool.file_option("--irradcache", options.light.irradcache, ".irradcache file, or a pattern: indirect light");
  tool.file_option("--meshirrad", options.light.meshirrad,
                   ".meshirrad file of st-filter mesh, or a pattern: indirect light, in place of a cache");
  tool.file_option("--points", options.light.points,
                   ".irradpoints file, or a pattern: a path ends at a hit that a point represents; with --irradcache "
                   "only paths that find no record do");
  tool.file_option(
      "--high", options.light.high,
      "high part from photonmap-split, or a pattern; --points (without --points: --photons) is then the low "
      "part. Without --irradcache bright points are sampled explicitly");
  tool.number_option("--neighbours", options.light.photon_light.neighbours, 2, kMaxNeighbours,
                     "photons per density estimate of indirect light");
  tool.number_option("--caustic-neighbours", options.light.photon_light.caustic_neighbours, 2, kMaxNeighbours,
                     "photons per density estimate of caustic light: fewer are sharper, more are smoother");
  app.add_option("--influence", options.light.influence.low,
                 "up to this influence of the movers, as a share of the static irradiance, indirect light is read from "
                 "static records, updated by dynamic photons; from 2.5 times this influence on it is gathered anew; "
                 "blended in between")
      ->capture_default_str()
      ->check(tools::number_above(0));
}

void add_options(tools::Tool& tool, Options& options) {
  CLI::App& app = tool.app();
  app.add_option("scene", options.scene, "glTF 2.0 scene, .gltf or .glb")->required();
  tool.size_option("--size", options.width, options.height, "picture size in pixels");
  tool.number_option("--spp", options.frame.samples, 1, 1 << 24,
                     "samples per pixel; with --pixel-error the number of first samples");
  tool.number_option("--pixel-error", options.pixel_error, -1.0, 1.0,
                     "relative error X that a pixel may have: noisy pixels get n = 12 (sigma / (12 X radiance))^0.875 "
                     "samples; 0: no further samples; -1: 0.01 with photons or a cache, else 0");
  tool.number_option(
      "--seen-error", options.frame.seen_error, 0.0, 255.0,
      "sample until the noise of the picture is below this, in 8-bit sRGB codes at the exposure that maps "
      "the picture's median to .18; --pixel-error then only distributes the samples; 0: off");
  app.add_flag("--for-filter", options.frame.for_filter,
               "for frames that st-filter will filter: --pixel-error counts only the noise of the layer specular, "
               "which passes the filter");
  app.add_flag("--keep-outliers", options.keep_outliers,
               "do not spread light that a single sample found; without this option --pixel-error spreads it over the "
               "surrounding pixels, which keeps each layer's sum; --integrator path never spreads");
  add_light_options(tool, options);
  tool.number_option(
      "--audit", options.audit, 0.0, 100.0,
      "report the bias of direct, caustic and indirect light, measured with separate photons and paths that "
      "take about this share of the frame's rays; 0: off");
  app.add_flag("--halves", options.frame.halves,
               "also write NAME_a.exr and NAME_b.exr, halves of spp/2 samples each; the halves are independent of each "
               "other, and of a frame with the same --seed but without --halves");
  app.add_option(
         "--channels", options.channels,
         "RGBA, layers (or emission, specular, direct, caustic, indirect, volume), Z, N, P, id, albedo, motion, "
         "coverage, influence, variance, diffuse.variance, samples, halves, seen")
      ->delimiter(',')
      ->type_name("NAMES")
      ->default_str("RGBA,Z,N,id");
  tool.file_option("--mask", options.mask, "EXR file, or a pattern: trace only pixels where a channel is not 0");
  tool.file_option("--base", options.base,
                   "EXR file, or a pattern, from which the pixels outside --mask are copied, bit for bit");
  app.add_flag("--half", options.half_float, "colour as 16-bit floats; refuses values above 65504");
  tool.choice_option("--compression", options.compression, {"zip", "none"}, "EXR compression");
  tool.output_option(options.output, "EXR file, or a pattern as f.####.exr")->required();
}

}  // namespace

int main(int argc, char** argv) {
  tools::Tool tool("frame-render",
                   "Trace the pixels of a frame: by path tracing, from a photon map, or from an irradiance cache.",
                   argc, argv);
  Options options;
  options.frame.samples = 8;
  add_options(tool, options);
  tool.common_options(tools::uses_scene | tools::uses_seed | tools::uses_camera | tools::uses_frames);

  return tool.run([&] {
    const std::vector<int>& frames = tool.common().frames;
    check(tool, options);
    tool.stats().phase("load");
    tools::SceneInput input(tool, options.scene, tools::SceneInput::a_camera);
    warn_of_darkness(tool, input.scene());
    StaticTree standing;
    for (int frame : frames) render(tool, input, options, frame, standing);
    return tools::exit_ok;
  });
}
