// tempolux-info -- shows the content of files: facts, validity, digest, differences, pictures, points.
//
//     tempolux-info f.0012.photons --scene room.glb
//     tempolux-info --diff a.exr b.exr || echo they differ
//     photon-trace room.glb -o - | tempolux-info - --export - | head
//     tempolux-info --sheet all.png --layer indirect f.*.exr
#include <CLI/CLI.hpp>
#include <iostream>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "formats/error.h"
#include "lib/scene/gltf_load.h"
#include "tools/common/tool_main.h"
#include "tools/info/info_facts.h"

using namespace tempolux;
using tools::Facts;

namespace {

struct Request {
  std::vector<std::string> files;
  bool check = false, digest = false, diff = false, json = false, account = false;
  std::string exported, png, sheet, scene;
  tools::PictureOptions picture;

  /// The file to write, by the one option that names it; "": none.
  const std::string& written() const { return !sheet.empty() ? sheet : !png.empty() ? png : exported; }
};

void print(const Facts& facts, bool as_json) {
  if (as_json) std::cout << facts.dump(2, ' ', false, Facts::error_handler_t::replace) << '\n';
  else std::cout << tools::facts_as_text(facts);
}

/// Checks files. Returns exit code 1 if a file is not valid; a missing file is bad usage.
int check_files(tools::Tool& tool, const Request& request) {
  int code = tools::exit_ok;
  for (const std::string& file : request.files) {
    try {
      tools::facts_of(file, false);
      if (!request.json) std::cout << file << ": valid\n";
    } catch (const InputError& error) {
      if (file != "-" && !CLI::ExistingFile(file).empty()) throw;
      tool.warn(error.what());
      code = tools::exit_differs;
    }
  }
  return code;
}

/// Adds the names of objects beside their ids.
void name_objects(const std::vector<std::string>& names, Facts& facts) {
  if (!facts.contains("by_object")) return;
  for (Facts& line : facts["by_object"])
    if (const std::size_t id = line["object"]; id < names.size()) line["name"] = names[id];
}

int print_files(tools::Tool& tool, const Request& request) {
  Facts all = Facts::array();
  std::vector<std::string> names;
  if (!request.scene.empty()) {
    tool.depends_on(request.scene);
    names = load_gltf(request.scene).object_names;
  }
  for (const std::string& file : request.files) {
    Facts facts = tools::facts_of(file, true);
    name_objects(names, facts);
    if (request.digest && !request.json) std::cout << facts["digest"].get<std::string>() << "  " << file << '\n';
    else if (request.digest) all.push_back({{"file", file}, {"digest", facts["digest"]}});
    else if (request.json) all.push_back(facts);
    else print(facts, false);
  }
  if (request.json) print(all.size() == 1 ? all[0] : all, true);
  return tools::exit_ok;
}

/// The single file that the option accepts.
const std::string& only_file(const Request& request, const char* option) {
  if (request.files.size() != 1) throw InputError(std::string(option) + ": takes one file");
  return request.files.front();
}

int answer(tools::Tool& tool, Request& request) {
  for (const std::string& file : request.files) tool.depends_on(file);
  if (request.diff) {
    if (request.files.size() != 2) throw InputError("--diff: takes two files");
    const Facts facts = tools::difference_of(request.files[0], request.files[1]);
    const bool equal = facts["equal"];
    if (request.json || !equal || !facts["differing"].empty()) print(facts, request.json);
    return equal ? tools::exit_ok : tools::exit_differs;
  }
  if (request.check) return check_files(tool, request);
  if (request.account) {
    const tools::FramesAccount account = tools::account_of_frames(request.files);
    if (!account.line.empty()) std::cout << account.line << '\n';
    for (const std::string& warning : account.warnings) tool.warn(warning);
    return tools::exit_ok;
  }
  if (request.written().empty()) return print_files(tool, request);
  const bool ply = request.exported.ends_with(".ply");
  if (!request.exported.empty() && !ply && request.exported != "-" && !request.exported.ends_with(".csv"))
    throw InputError("--export " + request.exported + ": the name must end in .ply or .csv");
  using Kind = tools::Output::Kind;
  tools::Output output(request.written(), request.exported.empty() || ply ? Kind::binary : Kind::text);
  request.picture.progress = [&](double done) { tool.progress(done); };
  if (!request.sheet.empty()) tools::write_sheet(request.files, request.picture, output);
  else if (!request.png.empty()) tools::write_picture(only_file(request, "--png"), request.picture, output);
  else tools::export_points(only_file(request, "--export"), ply ? "ply" : "csv", output);
  output.commit();
  return tools::exit_ok;
}

void declare(tools::Tool& tool, Request& request) {
  CLI::App& app = tool.app();
  tool.file_option("files", request.files, "files; -: a .photons, .irradpoints or .irradcache file on standard input")
      ->required();
  CLI::Option* check = app.add_flag("--check", request.check, "read each whole file; exit 1 if one is not valid");
  CLI::Option* digest = app.add_flag("--digest", request.digest, "hash of the data, without header and history");
  CLI::Option* diff = app.add_flag("--diff", request.diff, "differences of two files; exit 1 if their data differ");
  CLI::Option* account =
      app.add_flag("--account", request.account, "bias of the light of several frames together, from their audits");
  tool.file_option("--scene", request.scene, "glTF scene of the files: its objects get their names beside their ids")
      ->excludes(check, digest, diff, account);
  app.add_flag("--json", request.json, "facts as JSON instead of text");
  CLI::Option* exported = tool.output_option(
      request.exported, "photons, irradiance points or records as points, .ply or .csv; - is CSV on standard output",
      "--export");
  CLI::Option* png = tool.output_option(
      request.png, "write the image as PNG; for a .meshirrad file its elements, seen from a corner above", "--png");
  CLI::Option* sheet = tool.output_option(request.sheet, "all images in one picture, one exposure for all", "--sheet");
  app.add_option("--layer", request.picture.layer,
                 "layer or channel to show, such as indirect, Z, N; none: R, G, B; for a .meshirrad file: window (33 "
                 "frames: white) or age (red: later frames, blue: earlier ones)")
      ->type_name("NAME");
  tool.auto_option("--exposure", request.picture.exposure_stops, -200, 200,
                   "stops: brightness times 2^STOPS; auto: 98 % of the pixels below 0.9")
      ->type_name("STOPS");
  tool.number_option("--columns", request.picture.columns, 0, 1000, "columns of --sheet; 0: about square")
      ->type_name("N");
  tool.number_option("--tile", request.picture.tile_width, 1, 65536, "largest width of an image in --sheet, pixels")
      ->type_name("PX");
  app.add_option("--mark", request.picture.marked, "files whose pictures get a border in --sheet, such as key frames")
      ->type_name("FILES")
      ->delimiter(',')
      ->allow_extra_args(false)
      ->needs(sheet);
  const std::vector<CLI::Option*> modes{check, digest, diff, account, exported, png, sheet};
  for (CLI::Option* one : modes)
    for (CLI::Option* other : modes)
      if (one != other) one->excludes(other);
}

}  // namespace

int main(int argc, char** argv) {
  tools::Tool tool("tempolux-info",
                   "Show what is in .photons, .irradpoints, .irradcache, frames and other images, and our JSON files.",
                   argc, argv);
  Request request;
  declare(tool, request);
  tool.common_options(0);
  return tool.run([&] { return answer(tool, request); });
}
