#include "tools/stages/write_report.h"

#include <filesystem>
#include <optional>
#include <utility>

#include "formats/error.h"
#include "lib/report/gnuplot.h"
#include "lib/report/report_page.h"
#include "tools/common/output.h"

namespace tempolux::tools {
namespace {

ReportInput read_input(const ReportOptions& o) {
  if (o.manifest.empty() && o.runs.empty()) throw InputError("no runs; give a manifest, or --run");
  ReportInput input = o.manifest.empty() ? ReportInput{} : read_manifest(o.manifest);
  for (std::size_t i = 0; i + 2 < o.runs.size(); i += 3) add_run(input, o.runs[i], o.runs[i + 1], o.runs[i + 2]);
  if (input.runs.empty() && input.points.empty()) throw InputError(o.manifest + ": lists no run");
  if (!o.title.empty()) input.title = o.title;
  return input;
}

Plots draw(Tool& tool, const std::vector<SceneReport>& scenes) {
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

}  // namespace

int write_report(Tool& tool, const ReportOptions& o) {
  tool.stats().phase("load");
  const ReportInput input = read_input(o);
  for (const std::string& file : input.files) tool.depends_on(file);
  std::error_code error;
  std::filesystem::create_directories(o.folder, error);
  if (error) throw ResourceError(o.folder + ": cannot create this folder: " + error.message());
  const std::string folder = o.folder + "/";
  Output page(folder + "index.html", Output::Kind::text);
  const auto write = [&](Output output, const std::string& content) {
    output.write(content.data(), content.size());
    output.commit();
  };

  tool.stats().phase("fit");
  const std::vector<SceneReport> scenes = scene_reports(input);
  tool.stats().phase("plot");
  const Plots plots = draw(tool, scenes);

  tool.stats().phase("write");
  const std::string html = report_html(input, scenes, plots);
  write(Output(folder + "report.md", Output::Kind::text), report_markdown(input, scenes, plots));
  for (const auto& [name, bytes] : plots) write(Output(folder + name), bytes);
  write(std::move(page), html);
  tool.stats().count("runs", double(input.runs.size()));
  tool.stats().count("plots", double(plots.size()));
  return exit_ok;
}

}  // namespace tempolux::tools
