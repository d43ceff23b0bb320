// tempolux-info -- shows the content of files: facts, validity, digest, differences, pictures, points.
//
//     tempolux-info f.0012.photons --scene room.glb
//     tempolux-info --diff a.exr b.exr || echo they differ
//     photon-trace room.glb -o - | tempolux-info - --export - | head
//     tempolux-info --sheet all.png --layer indirect f.*.exr
#include <string>
#include <vector>

#include "tools/common/cli.h"
#include "tools/common/tool_main.h"
#include "tools/info/info_answer.h"

using namespace tempolux;

namespace {

void declare(tools::Tool& tool, tools::Request& request) {
  CLI::App& app = tool.app();
  tool.file_option("files", request.files, "files; -: a .photons, .irradpoints or .irradcache file on standard input")
      ->required();
  CLI::Option* check = app.add_flag("--check", request.check, "read each whole file; exit 1 if one is not valid");
  CLI::Option* whole =
      app.add_flag("--whole", request.whole, "look at the end of each file only; exit 1 if one was cut off");
  CLI::Option* digest = app.add_flag("--digest", request.digest, "hash of the data, without header and history");
  CLI::Option* diff = app.add_flag("--diff", request.diff, "differences of two files; exit 1 if their data differ");
  CLI::Option* account =
      app.add_flag("--account", request.account, "bias of the light of several frames together, from their audits");
  tool.file_option("--scene", request.scene, "glTF scene of the files: its objects get their names beside their ids")
      ->excludes(check, whole, digest, diff, account);
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
  tool.list_option("--mark", request.picture.marked, "files whose pictures get a border in --sheet, such as key frames")
      ->type_name("FILES")
      ->allow_extra_args(false)
      ->needs(sheet);
  const std::vector<CLI::Option*> modes{check, whole, digest, diff, account, exported, png, sheet};
  for (CLI::Option* one : modes)
    for (CLI::Option* other : modes)
      if (one != other) one->excludes(other);
}

}  // namespace

int main(int argc, char** argv) {
  tools::Tool tool("tempolux-info",
                   "Show what is in .photons, .irradpoints, .irradcache, frames and other images, and our JSON files.",
                   argc, argv);
  tools::Request request;
  declare(tool, request);
  tool.common_options(0);
  return tool.run([&] { return tools::answer(tool, request); });
}
