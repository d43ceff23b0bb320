#include "tools/stages/filter_mesh.h"

#include <CLI/CLI.hpp>
#include <cmath>
#include <string>
#include <vector>

#include "formats/text_header.h"
#include "lib/gather/mesh_elements.h"
#include "tools/common/option_words.h"
#include "tools/common/scene_input.h"

namespace tempolux::tools {
namespace {

struct Options {
  std::string scene, photons, output, filter = "gaussian";
  std::vector<std::string> kinds{"indirect"};
  MeshOptions mesh;
};

constexpr const char* kKinds[] = {"direct", "caustic", "indirect"};

bool wants(const Options& options, formats::PathKind kind) {
  return std::size_t(kind) < 3 && std::ranges::find(options.kinds, kKinds[std::size_t(kind)]) != options.kinds.end();
}

/// 2^-44 of what all lamps emit, a power of two: a sum holds 2^19 times that flux.
double unit_of(double emitted) { return std::exp2(std::clamp(std::ceil(std::log2(std::max(emitted, 1e-300))), -900.0, 900.0) - 44); }

std::string filter_text(const MeshFilter& filter, const std::string& name) {
  return filter.kind == MeshFilter::Kind::none ? name : name + " " + formats::text_of(filter.width);
}

formats::PhotonMap read_map(Tool& tool, const std::string& name, const SceneFrame& frame, const Options& options) {
  formats::PhotonMap map = formats::load_photons(name, [&](const formats::PhotonHeader&, const formats::Photon& photon) { return wants(options, photon.kind); });
  tool.depends_on(name);
  check_identity(tool, name, map.header.identity, frame);
  if (map.header.map != "global" || !map.header.part.empty())
    throw InputError(name + ": holds a part of the light (" + (map.header.part.empty() ? map.header.map : map.header.part) + "); name a global map");
  for (const std::string& kind : options.kinds)
    if (("," + map.header.kinds + ",").find("," + kind + ",") == std::string::npos)
      throw InputError(name + ": has no photons of kind " + kind + "; trace them with --kinds, or leave the kind out");
  return map;
}

void make_texture(Tool& tool, SceneInput& input, const Options& options, int number, StandingTree& standing) {
  Output output(frame_name(options.output, number), tool.common().no_clobber, Output::Kind::binary);
  tool.stats().phase("evaluate");
  const SceneFrame frame = input.at(number);
  tool.stats().phase("read photons");
  const std::string name = frame_name(options.photons, number);
  const formats::PhotonMap map = read_map(tool, name, frame, options);
  tool.stats().phase("build");
  const Tracer tracer(frame, standing);
  tool.stats().phase("count", true);
  const MeshOptions mesh = with_widths(options.mesh, frame, map.photons.size());
  const auto& o = map.header.origin;
  const double emitted = map.totals.emitted_flux[0] + map.totals.emitted_flux[1] + map.totals.emitted_flux[2];
  MeshSums sums(tracer, mesh.cell, unit_of(emitted));
  sums.add(map.photons, Vec3(Vec3d{o[0], o[1], o[2]} - frame.origin));
  tool.stats().phase("filter", true);
  formats::MeshirradFile file;
  file.header.history = map.header.history + tool.history_line(number);
  file.header.identity = identity_of(frame);
  file.header.origin = {frame.origin.x, frame.origin.y, frame.origin.z};
  file.header.cell = mesh.cell;
  file.header.unit = sums.unit();
  file.header.kinds.clear();
  for (const char* kind : kKinds)
    if (std::ranges::find(options.kinds, kind) != options.kinds.end()) file.header.kinds += (file.header.kinds.empty() ? "" : ",") + std::string(kind);
  file.header.filter = filter_text(mesh.filter, options.filter);
  file.elements = light_texture(frame, sums, mesh.filter);
  tool.stats().phase("write");
  formats::write_meshirrad([&](const void* data, std::size_t size) { output.write(data, size); }, file);
  output.commit();
  tool.stats().end_phase();
  if (sums.lost() * 100 > map.photons.size())
    tool.warn(name + ": no surface was found for " + std::to_string(sums.lost()) + " of " + std::to_string(map.photons.size()) + " photons");
  tool.stats().count("photons", double(map.photons.size()));
  tool.stats().count("lost_photons", double(sums.lost()));
  tool.stats().count("elements", double(file.elements.size()));
}

}  // namespace

int filter_mesh(int argc, char** argv) {
  Tool tool("st-filter mesh", "Make light textures: photons counted by small triangles of the surfaces, smoothed along them.", argc, argv);
  Options options;
  CLI::App& app = tool.app();
  app.add_option("scene", options.scene, "glTF 2.0 scene, .gltf or .glb")->required();
  app.add_option("--photons", options.photons, ".photons file of the frame, or a pattern")->type_name("FILE")->required();
  app.add_option("--kinds", options.kinds, "kinds of light that are counted: direct,caustic,indirect; frame-render takes indirect alone")
      ->delimiter(',')->type_name("NAMES")->default_str("indirect")->check(CLI::IsMember({"direct", "caustic", "indirect"}));
  app.add_option("--cell", options.mesh.cell, "longest edge of an element, m; 0: the filter's width")
      ->capture_default_str()->check(number_between(0));
  app.add_option("--filter", options.filter, "how elements are smoothed")
      ->capture_default_str()->check(CLI::IsMember({"none", "box", "gaussian", "bilateral"}));
  app.add_option("--filter-width", options.mesh.filter.width,
                 "half a box's edge, or a Gaussian's standard deviation, m; 0: so wide that 256 photons count in the mean")
      ->capture_default_str()->check(number_between(0));
  tool.output_option(options.output, ".meshirrad file, or a pattern; - for standard output")->required();
  tool.common_options(uses_scene | uses_frames);
  return tool.run([&] {
    const std::vector<int>& frames = tool.common().frames;
    if (frames.size() > 1 && !has_frame_pattern(options.output))
      throw InputError("--output: several frames need a pattern, for example m.####.meshirrad");
    using Kind = MeshFilter::Kind;
    options.mesh.filter.kind = options.filter == "none" ? Kind::none : options.filter == "box" ? Kind::box
                               : options.filter == "bilateral" ? Kind::bilateral : Kind::gaussian;
    tool.stats().phase("load");
    SceneInput input(tool, options.scene, SceneInput::nothing);
    StandingTree standing;
    for (const int frame : frames) make_texture(tool, input, options, frame, standing);
    return exit_ok;
  });
}

}  // namespace tempolux::tools
