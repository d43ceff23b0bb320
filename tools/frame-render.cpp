// frame-render -- trace the pixels of a frame: by path tracing, from a photon map, or from an irradiance cache.
//
//     frame-render room.glb --frame 12 --size 640x360 --spp 256 --halves -o ref.0012.exr
//     frame-render room.glb --frame 12 --size 640x360 --photons p.0012.photons -o f.0012.exr
//     frame-render room.glb --frame 12 --size 640x360 --irradcache c.0012.irradcache --photons p.0012.photons
//                  -o f.0012.exr
//
// Channels and attributes: formats/frames/frames.md.
#include "lib/core/formatted.h"
#include "tools/common/cli.h"
#include "tools/common/option_words.h"
#include "tools/stages/render_frame.h"

using namespace tempolux;

namespace {

void add_light_options(tools::Tool& tool, tools::RenderOptions& options) {
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
  tool.file_option(
      "--points", options.light.points,
      ".irradpoints file, or a pattern. Paths end where a point holds the indirect light; with --irradcache "
      "only paths that find no record use the points");
  tool.file_option(
      "--high", options.light.high,
      "high part from photonmap-split, or a pattern; --points (without --points: --photons) is then the low "
      "part. Without --irradcache bright points are sampled explicitly");
  tool.number_option("--neighbours", options.light.photon_light.neighbours, 2, kMaxNeighbours,
                     "photons per density estimate of indirect light");
  tool.number_option("--caustic-neighbours", options.light.photon_light.caustic_neighbours, 2, kMaxNeighbours,
                     "photons per density estimate of caustic light: fewer are sharper, more are smoother");
  app.add_option("--influence", options.light.influence.low,
                 formatted("up to this influence of the movers, as a share of the static irradiance, indirect light is "
                           "read from static records, updated by dynamic photons; from %.3g times this influence on it "
                           "is gathered anew; blended in between",
                           double(InfluenceThresholds{}.ratio())))
      ->capture_default_str()
      ->check(tools::number_above(0));
}

void add_still_options(tools::Tool& tool, tools::StillOptions& still) {
  tool.file_option(
      "--still", still.frame,
      "EXR file, a frame of another moment with the same camera. A few samples of both moments measure how "
      "a pixel changes. Pixels whose change has little noise become this frame plus the change; the "
      "others are sampled anew");
  tool.number_option("--still-frame", still.number, 0, 1 << 30, "with --still: the frame that it shows");
  tool.file_option("--still-photons", still.light.photons, "with --still: --photons of that moment");
  tool.file_option("--still-dynamic", still.light.dynamic, "with --still: --dynamic of that moment");
  tool.file_option("--still-irradcache", still.light.irradcache, "with --still: --irradcache of that moment");
  tool.file_option("--still-points", still.light.points, "with --still: --points of that moment");
  tool.file_option("--still-high", still.light.high, "with --still: --high of that moment");
}

void add_options(tools::Tool& tool, tools::RenderOptions& options) {
  CLI::App& app = tool.app();
  app.add_option("scene", options.scene, "glTF 2.0 scene, .gltf or .glb")->required();
  tool.size_option("--size", options.width, options.height, "picture size in pixels");
  tool.number_option("--spp", options.frame.samples, 1, 1 << 24,
                     "samples per pixel; with --pixel-error the number of first samples");
  tool.number_option(
      "--pixel-error", options.pixel_error, -1.0, 1.0,
      formatted(
          "relative error that a pixel may have: noisy pixels get further samples (docs/pixels.md); 0: no further "
          "samples; -1: %g with photons or a cache, else 0; with the channels halves and coverage, for "
          "st-filter, edges between surfaces get more samples and the inside of surfaces fewer",
          options.pixel_error_of_files));
  tool.number_option(
      "--seen-error", options.frame.seen_error, 0.0, 255.0,
      "sample until the noise of the picture is below this, in 8-bit sRGB codes at the exposure that maps "
      "the picture's median to .18; --pixel-error then only distributes the samples; 0: off");
  app.add_flag("--keep-outliers", options.keep_outliers,
               "do not spread light that a single sample found; without this option --pixel-error spreads it over the "
               "surrounding pixels, which keeps each layer's sum; --integrator path never spreads");
  add_light_options(tool, options);
  tool.number_option(
      "--audit", options.audit, 0.0, 100.0,
      "report the bias of direct, caustic and indirect light and of light in mirrors and glass, measured with separate "
      "photons and paths that take about this share of the frame's rays; 0: off");
  app.add_flag("--halves", options.frame.halves,
               "also write NAME_a.exr and NAME_b.exr, halves of spp/2 samples each; the halves are independent of each "
               "other, and of a frame with the same --seed but without --halves");
  tool.count_option(
      "--light-paths", options.light_paths,
      "with --integrator path: so many light paths add the light of lamps by way of mirrors and smooth glass, which "
      "few "
      "camera paths find and none of point, spot and sun lights, where the camera sees it without mirror or glass; 0: "
      "off");
  tool.list_option(
      "--channels", options.channels,
      "RGBA, layers (or emission, specular, direct, caustic, indirect, volume), Z, N, P, id, albedo, motion, coverage, "
      "influence, variance, diffuse.variance, samples, halves, seen, cryptomatte (mattes by object and by material)");
  tool.file_option("--mask", options.mask, "EXR file, or a pattern: trace only pixels where a channel is not 0");
  tool.file_option("--base", options.base,
                   "EXR file, or a pattern, from which the pixels outside --mask are copied, bit for bit");
  add_still_options(tool, options.still);
  app.add_flag("--half", options.half_float, "colour as 16-bit floats; refuses values above 65504");
  tool.choice_option("--compression", options.compression, {"zip", "none"}, "EXR compression");
  tool.output_option(options.output, "EXR file, or a pattern as f.####.exr")->required();
}

}  // namespace

int main(int argc, char** argv) {
  tools::Tool tool("frame-render",
                   "Trace the pixels of a frame: by path tracing, from a photon map, or from an irradiance cache.",
                   argc, argv);
  tools::RenderOptions options;
  options.frame.samples = 8;
  add_options(tool, options);
  tool.common_options(tools::uses_scene | tools::uses_seed | tools::uses_camera | tools::uses_frames);

  return tool.run([&] {
    tools::check(tool, options);
    tool.stats().phase("load");
    tools::SceneInput input(tool, options.scene, tools::SceneInput::a_camera);
    tools::render_frames(tool, input, options);
    return tools::exit_ok;
  });
}
