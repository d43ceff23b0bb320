// lib/report/scene_report.h -- the report of one scene: tables and the script of its plot.
#pragma once

#include <string>
#include <vector>

#include "lib/report/curves.h"
#include "lib/report/report_input.h"

namespace tempolux {

/// A table of the report.
struct Table {
  std::string heading;
  std::vector<std::string> header;
  std::vector<std::vector<std::string>> rows;
  std::string note;
};

/// What the report shows of one scene.
struct SceneReport {
  std::string scene;
  std::string file_stem;  ///< "error-SCENE", unique, of letters, digits, - _ only
  std::vector<Curve> curves;
  std::vector<CurveFit> fits;  ///< of each curve
  std::vector<GivenPoint> points;
  std::vector<Table> tables;  ///< runs, curves, speed-ups, given points; none is empty
};

/// One report per scene, in order of first appearance.
std::vector<SceneReport> scene_reports(const ReportInput& input);

enum class PlotFormat { svg, png };

/// A gnuplot script that draws error against time, with logarithmic axes, and writes the picture to standard output. It
/// draws the points of each curve, the fitted function sqrt(a/t + b) if it has a floor b, and the given points. The
/// legend gives each curve's slope and floor. Empty text if there is nothing to draw.
std::string plot_script(const SceneReport& report, PlotFormat format);

}  // namespace tempolux
