// photon-trace -- trace photons from the lights of a scene and record where they arrive.
//
//     photon-trace room.glb --frame 12 --photons 1M -o photons.0012.photons
//     photon-trace room.glb --frames 0-47 --photons 1M -o photons.####.photons
//
// Format: formats/photons/photons.md.
#include <CLI/CLI.hpp>
#include <string>
#include <vector>

#include "formats/photons/layout.h"
#include "formats/plan/view.h"
#include "lib/photon/photon_map.h"
#include "tools/common/scene_input.h"
#include "tools/common/tool_main.h"

using namespace tempolux;

namespace {

struct Options {
  std::string scene, output, photons = "1M", kinds = "direct,caustic,indirect", groups = "auto", importance;
};

/// 0 stands for automatic.
std::uint32_t group_count(const std::string& text) {
  if (text == "auto") return 0;
  const std::uint64_t count = tools::parse_count(text);
  if (count < 1 || count > formats::photons::kMaxGroupCount)
    throw InputError("--groups: " + text + " is not in 1 .. " + std::to_string(formats::photons::kMaxGroupCount));
  return std::uint32_t(count);
}

/// The spheres of a view file in scene space.
std::vector<AimSphere> aims_of(std::span<const formats::ViewSphere> view, Vec3d origin) {
  std::vector<AimSphere> aims;
  for (const formats::ViewSphere& sphere : view)
    aims.push_back({Vec3d{sphere.centre[0], sphere.centre[1], sphere.centre[2]} - origin, sphere.radius, sphere.weight});
  return aims;
}

/// An estimate of density by so many photons has a standard error of 14 %; fewer in each sphere and it reads light from
/// other spheres too.
constexpr std::uint64_t kNeededPerSphere = 50;

void warn_of_few(tools::Tool& tool, const Lights& lights, const PhotonMapResult& result, int frame_number) {
  const std::uint64_t needed = kNeededPerSphere * lights.aim().size(), seen = result.seen_count;
  tool.stats().count("photons_seen", double(seen));
  if (seen >= needed) return;
  tool.warn("frame " + std::to_string(frame_number) + ": only " + std::to_string(seen) + " photons lie where the cameras look, " +
            std::to_string(needed) + " are needed: indirect light will be rough; " +
            (seen == 0 ? "start more with --photons"
                       : "start " + std::to_string((result.path_count * needed + seen - 1) / seen) + " with --photons"));
}

void trace_frame(tools::Tool& tool, tools::SceneInput& input, const Options& options,
                 const std::vector<formats::ViewSphere>& view, int frame_number,
                 StandingTree& standing) {
  tools::Output output(tools::frame_name(options.output, frame_number), tool.common().no_clobber);
  tool.stats().phase("evaluate");
  const SceneFrame frame = input.at(frame_number);
  EmissionTable emission = input.emission(frame.frame);
  emission.aim = aims_of(view, frame.origin);
  tool.stats().phase("build");
  const Tracer tracer(frame, standing);
  const Lights lights(frame, emission);

  PhotonOptions photon_options;
  photon_options.seed = tool.common().seed_for_frame(frame_number);
  photon_options.photon_count = tools::parse_count(options.photons);
  photon_options.group_count = group_count(options.groups);
  photon_options.set_kinds(options.kinds);
  formats::PhotonHeader header;
  header.history = tool.history_line(frame_number);
  header.identity = tools::identity_of(frame);
  header.identity.emission = emission_hash(emission, frame.segment);
  header.origin = {frame.origin.x, frame.origin.y, frame.origin.z};

  tool.stats().phase("trace", true);
  const PhotonTracer photons(tracer, lights, photon_options);
  const PhotonMapResult result = write_photon_map(
      photons, photon_options, header, [&](const void* data, std::size_t size) { output.write(data, size); },
      [&](double fraction) { tool.progress(fraction); });
  tool.stats().phase("commit");
  output.commit();
  tool.stats().end_phase();
  if (!lights.aim().empty()) warn_of_few(tool, lights, result, frame_number);
  tool.stats().count("photons", double(result.totals.photon_count));
  tool.stats().count("paths", double(result.path_count));
  tool.stats().count("rays", double(result.ray_count));
  tool.stats().count("specular_rays", double(result.specular_ray_count));
  tool.stats().count("bytes_written", double(result.byte_count));
  tool.stats().count("refused_rays", double(tracer.refused_ray_count()));
}

}  // namespace

int main(int argc, char** argv) {
  tools::Tool tool("photon-trace", "Trace photons from the lights of a scene and record where they arrive.", argc,
                   argv);
  Options options;
  CLI::App& app = tool.app();
  app.add_option("scene", options.scene, "glTF 2.0 scene, .gltf or .glb")->required();
  app.add_option("--photons", options.photons,
                 "photon paths to start per frame (10k, 1M, 1G), rounded up to a multiple of the groups")
      ->capture_default_str();
  app.add_option("--kinds", options.kinds, "kinds of light to record: direct,caustic,indirect")->capture_default_str();
  app.add_option("--groups", options.groups, "photon groups N_g (photon i is of group i mod N_g), or auto")
      ->capture_default_str();
  app.add_option("--importance", options.importance,
                 "view file of scene-plan, state/view.SSSS: photons of sun and sky are aimed where the cameras look")
      ->type_name("FILE");
  app.add_option("-o,--output", options.output, ".photons file, or a pattern as f.####.photons; - for standard output")
      ->required();
  tool.common_options(tools::uses_scene | tools::uses_seed | tools::uses_frames);

  return tool.run([&] {
    const std::vector<int>& frames = tool.common().frames;
    if (frames.size() > 1 && !tools::has_frame_pattern(options.output))
      throw InputError("--output: several frames need a pattern, for example f.####.photons");
    tool.stats().phase("load");
    tools::SceneInput input(tool, options.scene, tools::SceneInput::light);
    StandingTree standing;
    std::vector<formats::ViewSphere> view;
    if (!options.importance.empty()) {
      view = formats::read_view(options.importance);
      tool.depends_on(options.importance);
    }
    for (int frame : frames) trace_frame(tool, input, options, view, frame, standing);
    return tools::exit_ok;
  });
}
