// volume-compose -- composites the smoke of a scene over a frame: light from photons and sampled lamps, in slices
// along each ray.
//
//     volume-compose room.glb --frame 12 --photons 12.photons --base 12.exr -o 12.smoke.exr
//     volume-compose room.glb --frame 12 --photons 12.photons --points 12.irradpoints --base 12.exr -o 12.smoke.exr
//     volume-compose room.glb --frames 0-23 --photons p.####.photons --base f.####.exr -o s.####.exr
//
// Method: docs/methods/volume_photons.md.
#include <string>
#include <utility>
#include <vector>

#include "lib/compose/smoke_layer.h"
#include "lib/gather/final_gather.h"
#include "lib/image/exr_io.h"
#include "lib/image/frame_identity.h"
#include "tools/common/cli.h"
#include "tools/common/scene_input.h"
#include "tools/common/tool_main.h"
#include "tools/stages/gather_input.h"
#include "tools/stages/smoke_base.h"

using namespace tempolux;

namespace {

struct Options {
  std::string scene, photons, points, base, output, direct = "rays";
  MediaLight::Options light;
  ComposeOptions compose;
  bool half_float = false;
};

/// The smoke in front of all pixels of a frame.
struct Smoke {
  std::vector<SmokePixel> pixels;
  std::string history;  ///< of the photons
  RayCounts rays;
};

/// `options`: with the names and the seed of the frame.
Smoke smoke_of(tools::Tool& tool, const Options& options, const RenderScene& scene, const CameraView& view,
               const tools::SmokeBase& base) {
  const SceneFrame& frame = scene.frame();
  MediaLight::Options light_options = options.light;
  if (!options.points.empty() && options.compose.sample_lights)
    light_options.rays = options.compose.samples * options.compose.light_samples;
  tool.stats().phase("photons");
  MediaLight light(*frame.media, frame.media->majorants(), eye_for_phase(view, frame.bounds),
                   channel_sum(scene.lights.total_flux()), light_options);
  Smoke smoke;
  smoke.history = tools::read_media_photons(tool, options.photons, frame, options.light.direct, light);
  tool.stats().phase("filter", true);
  light.finish();
  tool.stats().phase("march", true);
  ComposeOptions compose_options = options.compose;
  compose_options.surfaces_by_depth = !base.of_this_scene;
  compose_options.progress = tool.progress_sink();
  GatherPoints points;
  if (light.has_rays()) points = tools::read_points(tool, options.points, frame);
  const PointLookup lookup(points.points, points.spacing, point_clearance(scene.tracer));
  const IncomingRadiance incoming(scene.tracer, scene.lights, lookup);
  compose_options.incoming = &incoming;
  const Channel* const depth = base.image.find("Z");
  tool.stats().count("photons", double(light.sums().front().photons()));
  tool.stats().count("filter_width_cells", double(light.volume().width()));
  smoke.pixels =
      compose_media(scene, view, light, depth ? depth->values : std::vector<float>{}, compose_options, smoke.rays);
  return smoke;
}

void compose(tools::Tool& tool, tools::SceneInput& input, Options options, int number, StaticTree& tree) {
  for (std::string* name : {&options.output, &options.base, &options.photons, &options.points})
    *name = tools::frame_name(*name, number);
  options.compose.seed = tool.common().seed_for_frame(number);
  tools::Output output(options.output);
  tool.stats().phase("evaluate");
  const SceneFrame frame = input.at(number);
  Image image = load_exr(options.base);
  const CameraView view(frame, input.scene().camera_node(tool.common().camera), image.width, image.height);
  tools::SmokeBase base = tools::check_base(tool, options.base, std::move(image), frame, view);

  Smoke smoke{std::vector<SmokePixel>(base.image.pixel_count()), "", {}};
  if (frame.media) {
    tool.stats().phase("build");
    const Tracer tracer(frame, tree);
    const Lights lights(frame, input.emission(frame.frame));
    smoke = smoke_of(tool, options, {tracer, lights}, view, base);
  }
  add_smoke(smoke.pixels, base.attenuated || !frame.media, base.image);
  tool.stats().phase("write");
  base.image.text["tempolux:history"] += smoke.history + tool.history_line(number);
  set_identity(base.image, identity_of(frame));
  save_exr(output.temporary_path(), base.image, {options.half_float});
  output.commit();
  tool.stats().end_phase();
  tool.stats().count("rays", double(smoke.rays.camera + smoke.rays.shadow + smoke.rays.bounce));
}

void add_options(tools::Tool& tool, Options& options) {
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
  tool.number_option("--filter-width", options.light.filter_width, 0, 64,
                     "standard deviation of the Gaussian that smooths them, cells; 0: so wide that 256 photons count");
  app.add_flag("--half", options.half_float, "colour as 16-bit floats; refuses values above 65504");
  tool.output_option(options.output, "EXR file, or a pattern as f.####.exr")->required();
}

}  // namespace

int main(int argc, char** argv) {
  tools::Tool tool("volume-compose", "Composite the smoke of a scene over a frame, lit by photons and sampled lamps.",
                   argc, argv);
  Options options;
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
    for (const int frame : frames) compose(tool, input, options, frame, tree);
    return tools::exit_ok;
  });
}
