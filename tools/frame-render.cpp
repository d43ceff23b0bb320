// frame-render -- trace the pixels of a frame: by path tracing, or by looking up a photon map.
//
//     frame-render room.glb --frame 12 --size 640x360 --spp 256 --halves -o ref.0012.exr
//     frame-render room.glb --frame 12 --size 640x360 --spp 4 --photons p.0012.photons -o f.0012.exr
//
// Channels and attributes: formats/frames/frames.md.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <optional>
#include <string>
#include <vector>

#include "lib/render/frame_renderer.h"
#include "lib/render/photon_light.h"
#include "tools/frame_output.h"
#include "tools/scene_input.h"
#include "tools/tool_main.h"

using namespace tempolux;

namespace {

struct Options {
  std::string scene, frames = "0", output, size = "640x360", integrator = "auto", photons, compression = "zip";
  std::vector<std::string> channels{"RGBA", "Z", "N", "id"};
  FrameOptions frame;
  PhotonLightOptions photon_light;
  bool half_float = false;
  int width = 0, height = 0;
};

/// The neighbours in time that motion needs; empty unless it is asked for.
struct MotionFrame {
  std::optional<SceneFrame> frame;
  std::optional<CameraView> view;
  MotionFrame(tools::SceneInput& input, const Options& options, int camera, int number) {
    if (std::find(options.channels.begin(), options.channels.end(), "motion") == options.channels.end()) return;
    frame = input.at(number);
    view.emplace(frame->camera(camera), frame->origin, options.width, options.height);
  }
  NeighbourFrame get() const { return {frame ? &*frame : nullptr, view ? &*view : nullptr}; }
};

std::optional<PhotonLight> open_photons(tools::Tool& tool, const Options& options, const SceneFrame& frame, std::string& history) {
  if (options.photons.empty()) return std::nullopt;
  const std::string name = tools::frame_name(options.photons, frame.frame);
  tool.stats().phase("read photons");
  tool.depends_on(name);
  const formats::PhotonMap map = formats::load_photons(name);
  tools::check_identity(tool, name, map.header.identity, frame);
  history = map.header.history;
  tool.stats().phase("index photons", true);
  const Vec3d origin{map.header.origin[0], map.header.origin[1], map.header.origin[2]};
  return PhotonLight(map.photons, origin - frame.origin, frame.bounds, options.photon_light);
}

void render(tools::Tool& tool, tools::SceneInput& input, const Options& options, int frame_number) {
  tools::FrameOutputs outputs(tools::frame_name(options.output, frame_number), options.frame.halves, tool.common().no_clobber);
  tool.stats().phase("evaluate");
  const SceneFrame frame = input.at(frame_number);
  const int camera = input.scene().camera_node(tool.common().camera);
  const CameraView view(frame.camera(camera), frame.origin, options.width, options.height);
  const MotionFrame next(input, options, camera, frame_number + 1), previous(input, options, camera, frame_number - 1);
  tool.stats().phase("build");
  const Tracer tracer(frame);
  const Lights lights(frame, input.emission(frame.frame));
  const RenderScene scene{tracer, lights};
  tools::FrameDescription description{tools::identity_of(frame), "", frame.frame, input.time().fps, view.world_to_camera(), view.world_to_ndc()};
  const std::optional<PhotonLight> photon_light = open_photons(tool, options, frame, description.history);
  description.history += tool.history_line(frame_number);

  tool.stats().phase("render", true);
  FrameOptions frame_options = options.frame;
  frame_options.seed = tool.common().seed_for_frame(frame_number);
  frame_options.diffuse_light = photon_light ? &*photon_light : nullptr;
  frame_options.progress = [&](double fraction) { tool.progress(fraction); };
  const RenderedFrame rendered = render_frame(scene, view, frame_options);

  tool.stats().phase("data channels", true);
  Image image{options.width, options.height, {}, {}, {}, {}};
  add_data_channels(scene, view, options.channels, next.get(), previous.get(), image);
  tool.stats().phase("write");
  const ExrWriteOptions exr{options.half_float, options.compression == "none" ? ExrWriteOptions::Compression::none
                                                                              : ExrWriteOptions::Compression::zip};
  outputs.write(rendered, image, options.channels, description, exr);
  tool.stats().end_phase();

  tool.stats().count("camera_rays", double(rendered.rays.camera));
  tool.stats().count("bounce_rays", double(rendered.rays.bounce));
  tool.stats().count("shadow_rays", double(rendered.rays.shadow));
  tool.stats().count("lookups", double(rendered.rays.lookups));
  tool.stats().count("refused_rays", double(tracer.refused_ray_count()));
  tool.stats().set("samples_per_pixel", rendered.mean.samples);
  tool.stats().set("mean_radiance", rendered.mean_radiance);
  if (rendered.own_rmse >= 0) tool.stats().set("own_rmse", rendered.own_rmse);
}

void check(const Options& options, const std::vector<int>& frames) {
  if (frames.size() > 1 && !tools::has_frame_pattern(options.output))
    throw InputError("--output: several frames need a pattern, for example f.####.exr");
  if (options.output == "-") throw InputError("--output: frames are files, OpenEXR cannot be written to a pipe");
  if (options.integrator == "photons" && options.photons.empty())
    throw InputError("--integrator photons: name the photon map with --photons FILE");
  if (options.integrator == "path" && !options.photons.empty())
    throw InputError("--integrator path reads no photons; leave out --photons or the integrator");
  if ((options.frame.halves || options.frame.target_error > 0) && options.frame.samples % 2 != 0)
    throw InputError("--spp: halves need an even number of samples");
  check_channels(options.channels);
}

void add_options(CLI::App& app, Options& options) {
  app.add_option("scene", options.scene, "glTF 2.0 scene, .gltf or .glb")->required();
  app.add_option("--frame,--frames", options.frames, "frame, or range as 0-47, 0-47x2, 1,5,9")->capture_default_str();
  app.add_option("--size", options.size, "picture size in pixels, WxH")->capture_default_str();
  app.add_option("--spp", options.frame.samples, "samples per pixel; with --target-error the first number tried")
      ->capture_default_str()->check(CLI::Range(1, 1 << 24));
  app.add_option("--integrator", options.integrator,
                 "path: unbiased path tracing; photons: first bounce, then --photons; auto: by what is given")
      ->capture_default_str()->check(CLI::IsMember({"auto", "path", "photons"}));
  app.add_option("--photons", options.photons, ".photons file with indirect and caustic light, or a pattern");
  app.add_option("--neighbours", options.photon_light.neighbours, "photons per density estimate")
      ->capture_default_str()->check(CLI::Range(2, kMaxNeighbours));
  app.add_option("--max-radius", options.photon_light.max_radius,
                 "farthest photon used, m; 0: a twentieth of the scene's diagonal")
      ->capture_default_str()->check(CLI::NonNegativeNumber);
  app.add_flag("--halves", options.frame.halves,
               "also write NAME_a.exr and NAME_b.exr: independent halves of spp/2 samples each");
  app.add_option("--target-error", options.frame.target_error,
                 "double the samples until the estimated RMSE is below this fraction of the mean; 0: off")
      ->capture_default_str()->check(CLI::NonNegativeNumber);
  app.add_option("--max-spp", options.frame.max_samples, "never more samples than this for --target-error")->capture_default_str();
  app.add_option("--channels", options.channels,
                 "RGBA, layers (or emission, specular, direct, caustic, indirect), Z, N, P, id, albedo, motion")
      ->delimiter(',')->capture_default_str();
  app.add_flag("--half", options.half_float, "colour as 16-bit floats; refuses values above 65504");
  app.add_option("--compression", options.compression, "EXR compression")->capture_default_str()->check(CLI::IsMember({"zip", "none"}));
  app.add_option("-o,--output", options.output, "EXR file, or a pattern as f.####.exr")->required();
}

}  // namespace

int main(int argc, char** argv) {
  tools::Tool tool("frame-render", "Trace the pixels of a frame: by path tracing, or by looking up a photon map.", argc, argv);
  Options options;
  add_options(tool.app(), options);
  tool.common_options(tools::uses_scene | tools::uses_seed | tools::uses_camera);

  return tool.run([&] {
    const std::vector<int> frames = tools::parse_frames(options.frames);
    tools::parse_size(options.size, options.width, options.height);
    check(options, frames);
    tool.stats().phase("load");
    tools::SceneInput input(tool, options.scene);
    for (int frame : frames) render(tool, input, options, frame);
    return tools::exit_ok;
  });
}
