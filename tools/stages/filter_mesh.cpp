#include "tools/stages/filter_mesh.h"

#include <string>
#include <vector>

#include "formats/text_header.h"
#include "lib/core/formatted.h"
#include "tools/common/cli.h"
#include "tools/stages/count_photons.h"

namespace tempolux::tools {
namespace {

struct Options {
  std::string scene, output, filter = "gaussian";
  CountOptions count;
};

std::string filter_text(const MeshFilter& filter, const std::string& name) {
  return filter.kind == MeshFilter::Kind::none ? name : name + " " + formats::text_of(filter.width);
}

std::vector<Rgbd> flux_of(const formats::MeshirradFile& file) {
  std::vector<Rgbd> flux;
  for (const formats::MeshElement& e : file.elements)
    flux.push_back(Rgbd(double(e.sums[0]), double(e.sums[1]), double(e.sums[2])) * file.header.unit);
  return flux;
}

void make_texture(Tool& tool, SceneInput& input, const Options& options, int number, StaticTree& tree) {
  Output output(frame_name(options.output, number));
  tool.stats().phase("evaluate");
  const SceneFrame frame = input.at(number);
  const Tracer tracer(frame, tree);
  auto [file, mesh] = count_photons(tool, input, options.count, tracer);
  file.header.history += tool.history_line(number);
  if (!options.count.for_windows) {
    tool.stats().phase("filter", true);
    file.header.filter = filter_text(mesh.filter, options.filter);
    smooth_elements(tracer, flux_of(file), mesh.filter, {}, file.elements);
    leave_out_dark(file.elements);
  }
  write_mesh(tool, file, output);
}

}  // namespace

int filter_mesh(int argc, char** argv) {
  Tool tool("st-filter mesh",
            "Make light textures: photons counted by small triangles of the surfaces, smoothed along them.", argc,
            argv);
  Options options;
  CLI::App& app = tool.app();
  app.add_option("scene", options.scene, "glTF 2.0 scene, .gltf or .glb")->required();
  add_count_options(tool, options.count);
  app.get_option("--photons")->required();
  auto* counts =
      app.add_flag("--counts", options.count.for_windows,
                   "count alone, by elements that all frames of the segment share: for gather-temporal density");
  tool.choice_option("--filter", options.filter, {"none", "box", "gaussian"}, "how elements are smoothed")
      ->excludes(counts);
  tool.number_option(
      "--filter-width", options.count.mesh.filter.width, 0, kNoLimit,
      formatted(
          "half a box's edge, or a Gaussian's standard deviation, m; 0: so wide that %g photons count in the mean",
          kPhotonsInKernel));
  tool.output_option(options.output, ".meshirrad file, or a pattern; - for standard output")->required();
  tool.common_options(uses_scene | uses_camera | uses_frames);
  return tool.run([&] {
    const std::vector<int>& frames = tool.common().frames;
    tool.check_patterns({options.output});
    using Kind = MeshFilter::Kind;
    options.count.mesh.filter.kind = options.filter == "none"  ? Kind::none
                                     : options.filter == "box" ? Kind::box
                                                               : Kind::gaussian;
    tool.stats().phase("load");
    SceneInput input(tool, options.scene, SceneInput::nothing);
    StaticTree tree;
    for (const int frame : frames) make_texture(tool, input, options, frame, tree);
    return exit_ok;
  });
}

}  // namespace tempolux::tools
