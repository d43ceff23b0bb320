// tools/error-report.cpp -- error against run time: tables, plots and one page from measured runs.
//
//     error-report manifest.json -o report
//     error-report -o report --run 'scene=S2,curve=photon map,x=1000000' trace.json+render.json error.json
//
// Writes report.md, error-SCENE.svg, error-SCENE.png and index.html into the folder. Runs are
// pairs of stats (formats/stats) and comparison (formats/comparison); manifest: formats/report/report.md.
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "formats/error.h"
#include "lib/report/gnuplot.h"
#include "lib/report/report_page.h"
#include "tools/common/cli.h"
#include "tools/common/tool_main.h"

using namespace tempolux;

namespace {

struct Options {
  std::string manifest, folder = "report", title;
  std::vector<std::string> runs;
};

void declare(tools::Tool& tool, Options& o) {
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

ReportInput read_input(const Options& o) {
  if (o.manifest.empty() && o.runs.empty()) throw InputError("no runs; give a manifest, or --run");
  ReportInput input = o.manifest.empty() ? ReportInput{} : read_manifest(o.manifest);
  for (std::size_t i = 0; i + 2 < o.runs.size(); i += 3) add_run(input, o.runs[i], o.runs[i + 1], o.runs[i + 2]);
  if (input.runs.empty() && input.points.empty()) throw InputError(o.manifest + ": lists no run");
  if (!o.title.empty()) input.title = o.title;
  return input;
}

Plots draw(tools::Tool& tool, const std::vector<SceneReport>& scenes) {
  constexpr int kTimeout = 60;  // s that gnuplot may take for a plot
  Plots plots;
  for (const SceneReport& scene : scenes)
    for (const PlotFormat format : {PlotFormat::svg, PlotFormat::png}) {
      const std::string script = plot_script(scene, format);
      if (script.empty()) continue;
      const std::optional<std::string> drawn = run_gnuplot(script, kTimeout);
      if (!drawn) return tool.warn("gnuplot: not found; the report has no plots; install gnuplot-nox"), Plots{};
      plots[scene.file_stem + (format == PlotFormat::svg ? ".svg" : ".png")] = *drawn;
    }
  return plots;
}

int report(tools::Tool& tool, const Options& o) {
  tool.stats().phase("load");
  const ReportInput input = read_input(o);
  for (const std::string& file : input.files) tool.depends_on(file);
  std::error_code error;
  std::filesystem::create_directories(o.folder, error);
  if (error) throw ResourceError(o.folder + ": cannot create this folder: " + error.message());
  const std::string folder = o.folder + "/";
  tools::Output page(folder + "index.html", tools::Output::Kind::text);
  const auto write = [&](tools::Output output, const std::string& content) {
    output.write(content.data(), content.size());
    output.commit();
  };

  tool.stats().phase("fit");
  const std::vector<SceneReport> scenes = scene_reports(input);
  tool.stats().phase("plot");
  const Plots plots = draw(tool, scenes);

  tool.stats().phase("write");
  const std::string html = report_html(input, scenes, plots);
  write(tools::Output(folder + "report.md", tools::Output::Kind::text), report_markdown(input, scenes, plots));
  for (const auto& [name, bytes] : plots) write(tools::Output(folder + name), bytes);
  write(std::move(page), html);
  tool.stats().count("runs", double(input.runs.size()));
  tool.stats().count("plots", double(plots.size()));
  return tools::exit_ok;
}

}  // namespace

int main(int argc, char** argv) {
  tools::Tool tool("error-report", "Draw error against run time from measured runs.", argc, argv);
  Options options;
  declare(tool, options);
  return tool.run([&] { return report(tool, options); });
}
