// tools/error-report.cpp -- error against run time: tables, plots and one page from measured runs.
//
//     error-report manifest.json -o report
//     error-report -o report --run 'scene=S2,curve=photon map,x=1000000' trace.json+render.json error.json
//
// Writes report.md, error-SCENE.svg, error-SCENE.png and index.html into the folder. Runs are
// pairs of stats (formats/stats) and comparison (formats/comparison); manifest: formats/report/report.md.
#include "tools/common/cli.h"
#include "tools/common/tool_main.h"
#include "tools/stages/write_report.h"

using namespace tempolux;

namespace {

void declare(tools::Tool& tool, tools::ReportOptions& o) {
  CLI::App& app = tool.app();
  app.add_option("manifest", o.manifest, "JSON that lists the runs (formats/report/report.md)");
  app.add_option("--run", o.runs, "a run: KEY=VALUE,... (scene, curve, label, x) STATS+STATS... COMPARISON")
      ->type_size(3)
      ->allow_extra_args(false)
      ->type_name("WHAT STATS COMPARISON");
  tool.output_option(o.folder, "folder of report.md, index.html, plots")->capture_default_str();
  app.add_option("--title", o.title, "title of the report")->type_name("TEXT");
  tool.common_options(0);
}

}  // namespace

int main(int argc, char** argv) {
  tools::Tool tool("error-report", "Draw error against run time from measured runs.", argc, argv);
  tools::ReportOptions options;
  declare(tool, options);
  return tool.run([&] { return write_report(tool, options); });
}
