// tests/lib/report/report_test.cpp -- tables, plots and pages of a small report.
#include <gtest/gtest.h>

#include <cstdlib>

#include "formats/error.h"
#include "lib/report/gnuplot.h"
#include "lib/report/report_page.h"

namespace tempolux {
namespace {

MeasuredRun run_of(const std::string& curve, double x, double cpu_s, double mse) {
  MeasuredRun run;
  run.scene = "S <2>";
  run.curve = curve;
  run.label = curve + ", " + std::to_string(int(x));
  run.x = x;
  run.stages.resize(2);
  run.stages[0].cpu_s = run.stages[1].cpu_s = cpu_s / 2;
  run.stages[0].peak_memory_bytes = 3e6;
  run.stages[1].peak_memory_bytes = 5e6;
  run.error.emplace();
  run.error->mse = mse;
  run.error->halves = true;
  return run;
}

ReportInput example() {
  ReportInput input;
  for (int i = 0; i < 5; ++i) input.runs.push_back(run_of("path", 1 << 2 * i, 1 << 2 * i, 1e-2 / (1 << 2 * i)));
  for (int i = 0; i < 5; ++i) input.runs.push_back(run_of("map's", 1 << 2 * i, 1 << 2 * i, 1e-3 / (1 << 2 * i) + 1e-5));
  input.points.push_back({"S <2>", "peer", "", 8, 0.02});
  return input;
}

const Table& table_of(const SceneReport& report, const std::string& heading) {
  for (const Table& table : report.tables)
    if (table.heading == heading) return table;
  throw std::runtime_error("no table " + heading);
}

// Curve "map's" falls as 1e-3/t + 1e-5: floor sqrt(1e-5), ten times that at t = 10: points 1 and 4 carry the
// slope. Equal error: both reach .00833 (path's end is .00625; the map starts at .0318 and ends at .00373).
TEST(ReportTest, TablesCarrySlopeFloorSpeedUpAndGivenPoints) {
  const SceneReport report = scene_reports(example()).at(0);
  EXPECT_EQ(report.file_stem, "error-S__2_");
  const Table& fits = table_of(report, "Error against CPU s");
  EXPECT_EQ(fits.rows[0][3], "-0.500");
  EXPECT_EQ(fits.rows[0][6], "none seen");
  EXPECT_EQ(fits.rows[1][5], "2");
  EXPECT_EQ(fits.rows[1][6], "0.003162");
  const Table& faster = table_of(report, "Equal-error speed-up");
  ASSERT_EQ(faster.rows.size(), 3u);
  EXPECT_EQ(faster.rows[0][0], "map's");
  EXPECT_EQ(faster.rows[0][3], "1");  // at the map's first point, e^2 = .00101: path needs .01/.00101 = 9.9 s
  EXPECT_EQ(faster.rows[0][5], "9.90");
  const Table& given = table_of(report, "Given points, not measured here");
  EXPECT_EQ(given.rows[0][3], "0.32");  // path: .01/.0004 = 25 s; 8 / 25
}

TEST(ReportTest, PagesEscapeNamesAndEmbedPlots) {
  const ReportInput input = example();
  const auto scenes = scene_reports(input);
  const Plots plots{{"error-S__2_.svg", "<svg/>"}};
  const std::string html = report_html(input, scenes, plots);
  EXPECT_NE(html.find("<h2>S &lt;2&gt;</h2>"), std::string::npos);
  EXPECT_NE(html.find("data:image/svg+xml;base64,PHN2Zy8+\""), std::string::npos);  // RFC 4648 of <svg/>
  EXPECT_EQ(html.find("src=\"e"), std::string::npos);
  const std::string markdown = report_markdown(input, scenes, plots);
  EXPECT_NE(markdown.find("## S \\<2>\n"), std::string::npos);
  EXPECT_NE(markdown.find("(error-S__2_.svg)"), std::string::npos);
}

TEST(ReportTest, PlotShowsSlopeAndFloorAndQuotesNames) {
  const std::string script = plot_script(scene_reports(example()).at(0), PlotFormat::svg);
  EXPECT_NE(script.find("title 'path, slope -0.50'"), std::string::npos);
  EXPECT_NE(script.find("title 'map''s, slope "), std::string::npos);
  EXPECT_NE(script.find(", bias floor 0.0032'"), std::string::npos);
  EXPECT_EQ(plot_script(SceneReport{}, PlotFormat::svg), "");
}

TEST(GnuplotTest, DrawsTheSamePlotTwiceAndTellsOnWhatItFails) {
  const std::string script = plot_script(scene_reports(example()).at(0), PlotFormat::svg);
  const std::optional<std::string> drawn = run_gnuplot(script, 60);
  if (!drawn) GTEST_SKIP() << "no gnuplot";
  EXPECT_NE(drawn->find("<svg"), std::string::npos);
  EXPECT_EQ(drawn, run_gnuplot(script, 60));
  EXPECT_TRUE(run_gnuplot(plot_script(scene_reports(example()).at(0), PlotFormat::png), 60)->starts_with("\x89PNG"));
  try {
    run_gnuplot("plot nonsense(x)\n", 60);
    ADD_FAILURE() << "accepted";
  } catch (const ResourceError& error) {
    EXPECT_NE(std::string(error.what()).find("undefined function"), std::string::npos) << error.what();
  }
  EXPECT_THROW(run_gnuplot("pause 60\n", 1), ResourceError);
}

TEST(ReportInputTest, RunsOnTheCommandLineAreCheckedBeforeFilesAreOpened) {
  ReportInput input;
  EXPECT_THROW(add_run(input, "curve", "s.json", "c.json"), InputError);
  EXPECT_THROW(add_run(input, "label=a", "s.json", "c.json"), InputError);
  EXPECT_THROW(add_run(input, "curve=a,x=1e", "s.json", "c.json"), InputError);
  EXPECT_THROW(add_run(input, "curve=a", "no-such-file.json", "c.json"), InputError);
  EXPECT_TRUE(input.runs.empty());
}

}  // namespace
}  // namespace tempolux
