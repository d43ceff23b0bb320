// volume-compose -- composites the smoke of a scene over a frame: light from photons and sampled lamps, in slices
// along each ray.
//
//     volume-compose room.glb --frame 12 --photons 12.photons --base 12.exr -o 12.smoke.exr
//     volume-compose room.glb --frame 12 --photons 12.photons --points 12.irradpoints --base 12.exr -o 12.smoke.exr
//     volume-compose room.glb --frames 0-23 --photons p.####.photons --base f.####.exr -o s.####.exr
//
// Method: docs/methods/volume_photons.md.
#include <CLI/CLI.hpp>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "formats/photons/photons.h"
#include "lib/compose/compose.h"
#include "lib/gather/final_gather.h"
#include "lib/image/exr_io.h"
#include "lib/image/frame_identity.h"
#include "tools/common/option_words.h"
#include "tools/common/scene_input.h"
#include "tools/common/tool_main.h"
#include "tools/stages/gather_input.h"

using namespace tempolux;

namespace {

struct Options {
  std::string scene, photons, points, base, output, direct = "rays";
  MediaLight::Options light;
  ComposeOptions compose;
  bool half_float = false;
};

constexpr const char* kVolumeChannels[3] = {"volume.R", "volume.G", "volume.B"};
constexpr const char* kColours[3] = {"R", "G", "B"};

/// Properties of the base frame.
struct Base {
  Image image;
  bool attenuated = true;     ///< its light is already attenuated by the smoke
  bool of_this_scene = true;  ///< it shows the scene's surfaces
};

bool is_smoky(const Image& image) {
  for (const char* name : kVolumeChannels)
    if (const Channel* channel = image.find(name))
      for (const float value : channel->values)
        if (value != 0) return true;
  return false;
}

Base check_base(tools::Tool& tool, const std::string& path, Image read, const SceneFrame& frame,
                const CameraView& view) {
  Base base{std::move(read), true, true};
  tool.depends_on(path, tools::InputRole::replaceable);
  const Image& image = base.image;
  for (const char* name : kColours)
    if (!image.find(name)) throw InputError(path + ": has no channels R, G, B; a base is a frame in colour");
  if (is_smoky(image))
    throw InputError(
        path + ": has smoke in its layer volume already; give a frame without, as frame-render --irradcache makes it");
  const formats::Identity identity = identity_in(image);
  if (!identity.known()) {
    base.attenuated = base.of_this_scene = false;
    tool.warn(path +
              ": does not say which scene it shows: its channel Z is where smoke ends, and it is taken as not yet "
              "dimmed by the "
              "smoke; approximate at edges");
    if (!image.find("Z"))
      throw InputError(path + ": has no channel Z; without it nobody knows what lies before the smoke");
    return base;
  }
  formats::Identity without_media = identity;
  without_media.media.clear();
  tools::check_identity(tool, path, without_media, frame);
  if (!identity.media.empty() && identity.media != frame.hashes.media) {
    base.attenuated = false;
    tool.warn(path +
              ": was made without this smoke: it is dimmed here, a pixel at a time, and nothing in it is shaded by the "
              "smoke");
  }
  for (const auto& [name, matrix] :
       {std::pair{"worldToCamera", view.world_to_camera()}, std::pair{"worldToNDC", view.world_to_ndc()}}) {
    const auto found = image.matrices.find(name);
    if (found == image.matrices.end()) continue;
    for (std::size_t i = 0; i < 16; ++i)
      if (float(found->second[i]) != float(matrix[i]))
        throw InputError(path + ": seen by another camera than that of frame " + std::to_string(frame.frame) +
                         "; give a base of this view");
  }
  return base;
}

/// Reads the photons of the frame into the volume.
std::string read_photons(tools::Tool& tool, const std::string& path, const SceneFrame& frame, const Options& options,
                         MediaLight& light) {
  formats::PhotonReader reader(path, {.digest = false});
  tool.depends_on(path);
  tools::check_identity(tool, path, reader.header().identity, frame);
  if (reader.header().kinds.find("tentative") == std::string::npos)
    throw InputError(path + ": has no photons in media; trace them with --kinds volume among others");
  if (options.light.direct && reader.header().kinds.find("direct") == std::string::npos)
    throw InputError(path + ": has no direct light; trace it with --kinds direct among others, or use --direct rays");
  if (frame.media->directional() && !(reader.header().columns & formats::column_direction))
    throw InputError(path + ": has no directions, which a phase function with g needs; trace the photons again");
  const auto& o = reader.header().origin;
  const Vec3 offset{float(o[0] - frame.origin.x), float(o[1] - frame.origin.y), float(o[2] - frame.origin.z)};
  formats::PhotonBlock block;
  while (reader.read_block(block)) light.add(block, offset);
  return reader.header().history;
}

void put_smoke(const std::vector<SmokePixel>& smoke, const Base& base, Image& image) {
  for (const char* name : kVolumeChannels)
    if (!image.find(name)) image.add(name);
  for (std::size_t p = 0; p < smoke.size(); ++p) {
    const float transmittance = base.attenuated ? 1 : smoke[p].transmittance;
    if (transmittance != 1)
      for (Channel& channel : image.channels) {
        const char last = channel.name.back();
        const bool colour = !channel.values.empty() &&
                            (channel.name.size() == 1 || channel.name[channel.name.size() - 2] == '.') &&
                            (last == 'R' || last == 'G' || last == 'B') && !channel.name.starts_with("albedo");
        if (colour) channel.values[p] *= transmittance;
      }
    for (std::size_t c = 0; c < 3; ++c) {
      image.find(kVolumeChannels[c])->values[p] = smoke[p].light[int(c)];
      image.find(kColours[c])->values[p] += smoke[p].light[int(c)];
    }
    if (Channel* alpha = image.find("A"); alpha && !base.attenuated)
      alpha->values[p] = 1 - transmittance * (1 - alpha->values[p]);
  }
}

/// The eye position for the phase functions; an orthographic camera is placed far away.
Vec3 eye_of(const CameraView& view, const PlacedCamera& camera, const SceneFrame& frame) {
  if (camera.camera.kind == Camera::Kind::perspective) return view.eye();
  const Ray middle = view.ray(0.5f * float(view.width()), 0.5f * float(view.height()));
  return middle.origin - middle.direction * (1e4f * std::max(1.0f, frame.bounds.diagonal()));
}

void compose(tools::Tool& tool, tools::SceneInput& input, const Options& options, int number, StaticTree& standing) {
  tools::Output output(tools::frame_name(options.output, number));
  tool.stats().phase("evaluate");
  const SceneFrame frame = input.at(number);
  const std::string base_name = tools::frame_name(options.base, number);
  const PlacedCamera camera = frame.camera(input.scene().camera_node(tool.common().camera));
  Image image = load_exr(base_name);
  const CameraView view(camera, frame.origin, image.width, image.height);
  Base base = check_base(tool, base_name, std::move(image), frame, view);
  const auto written = base.image.text.find("tempolux:history");
  std::string history = written == base.image.text.end() ? "" : written->second;

  RayCounts counts;
  if (frame.media) {
    tool.stats().phase("build");
    const Tracer tracer(frame, standing);
    const Lights lights(frame, input.emission(frame.frame));
    const Rgbd flux = lights.total_flux();
    tool.stats().phase("photons");
    MediaLight::Options light_options = options.light;
    if (!options.points.empty() && options.compose.sample_lights)
      light_options.rays = options.compose.samples * options.compose.light_samples;
    MediaLight light(*frame.media, frame.media->majorants(), eye_of(view, camera, frame), channel_sum(flux),
                     light_options);
    history += read_photons(tool, tools::frame_name(options.photons, number), frame, options, light);
    tool.stats().phase("filter", true);
    light.finish();
    tool.stats().phase("march", true);
    ComposeOptions compose_options = options.compose;
    compose_options.seed = tool.common().seed_for_frame(number);
    compose_options.surfaces_by_depth = !base.of_this_scene;
    compose_options.progress = [&](double fraction) { tool.progress(fraction); };
    GatherPoints points;
    if (light.has_rays()) points = tools::read_points(tool, tools::frame_name(options.points, number), frame);
    const PointLookup lookup(points.points, points.spacing, point_clearance(tracer));
    const IncomingRadiance incoming(tracer, lights, lookup);
    compose_options.incoming = &incoming;
    const Channel* const depth = base.image.find("Z");
    const std::vector<SmokePixel> smoke = compose_media(
        {tracer, lights}, view, light, depth ? depth->values : std::vector<float>{}, compose_options, counts);
    put_smoke(smoke, base, base.image);
    tool.stats().count("photons", double(light.sums().front().photons()));
    tool.stats().count("filter_width_cells", double(light.volume().width()));
  } else {
    put_smoke(std::vector<SmokePixel>(base.image.pixel_count()), {{}, true, true}, base.image);
  }
  tool.stats().phase("write");
  base.image.text["tempolux:history"] = history + tool.history_line(number);
  set_identity(base.image, identity_of(frame));
  save_exr(output.temporary_path(), base.image, {options.half_float, ExrWriteOptions::Compression::zip});
  output.commit();
  tool.stats().end_phase();
  tool.stats().count("rays", double(counts.camera + counts.shadow + counts.bounce));
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
    StaticTree standing;
    for (const int frame : frames) compose(tool, input, options, frame, standing);
    return tools::exit_ok;
  });
}
