#include "tools/stages/compose_smoke.h"

#include <utility>
#include <vector>

#include "lib/gather/final_gather.h"
#include "lib/image/exr_io.h"
#include "lib/image/frame_identity.h"
#include "tools/stages/gather_input.h"
#include "tools/stages/smoke_base.h"

namespace tempolux::tools {
namespace {

/// The smoke in front of all pixels of a frame.
struct Smoke {
  std::vector<SmokePixel> pixels;
  std::string history;  ///< of the photons
  RayCounts rays;
};

/// `options`: with the names and the seed of the frame.
Smoke smoke_of(Tool& tool, const SmokeOptions& options, const RenderScene& scene, const CameraView& view,
               const SmokeBase& base) {
  const SceneFrame& frame = scene.frame();
  MediaLight::Options light_options = options.light;
  if (!options.points.empty() && options.compose.sample_lights)
    light_options.rays = options.compose.samples * options.compose.light_samples;
  tool.stats().phase("photons");
  MediaLight light(*frame.media, frame.media->majorants(), eye_for_phase(view, frame.bounds),
                   channel_sum(scene.lights.total_flux()), light_options);
  Smoke smoke;
  smoke.history = read_media_photons(tool, options.photons, frame, options.light.direct, light);
  tool.stats().phase("filter", true);
  light.finish();
  tool.stats().phase("march", true);
  ComposeOptions compose_options = options.compose;
  compose_options.surfaces_by_depth = !base.of_this_scene;
  compose_options.progress = tool.progress_sink();
  GatherPoints points;
  if (light.has_rays()) points = read_points(tool, options.points, frame);
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

}  // namespace

void compose_smoke(Tool& tool, SceneInput& input, SmokeOptions options, int number, StaticTree& tree) {
  for (std::string* name : {&options.output, &options.base, &options.photons, &options.points})
    *name = frame_name(*name, number);
  options.compose.seed = tool.common().seed_for_frame(number);
  Output output(options.output);
  tool.stats().phase("evaluate");
  const SceneFrame frame = input.at(number);
  Image image = load_exr(options.base);
  const CameraView view(frame, input.scene().camera_node(tool.common().camera), image.width, image.height);
  SmokeBase base = check_base(tool, options.base, std::move(image), frame, view);

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

}  // namespace tempolux::tools
