// lib/report/plot_script.cpp -- writes a scene's curves as a gnuplot script.
#include <cmath>

#include "lib/report/scene_report.h"
#include "lib/report/text.h"

namespace tempolux {
namespace {

/// Text in single quotes, in which gnuplot interprets only a doubled quote. Control characters become spaces.
std::string quoted(const std::string& text) {
  std::string safe = "'";
  for (const char c : text) {
    if (c == '\'') safe += "''";
    else safe += static_cast<unsigned char>(c) < 0x20 || c == 0x7f ? ' ' : c;
  }
  return safe + "'";
}

std::string key_text(const Curve& curve, const CurveFit& fit) {
  std::string text = curve.name;
  if (fit.slope) text += ", slope " + number_text(fit.slope, "%.2f");
  if (fit.floor) text += ", bias floor " + number_text(fit.floor, "%.2g");
  return text;
}

/// Range of an axis over the positive values, with a margin of a fifth of a decade.
struct Range {
  double low = INFINITY, high = 0;
  void include(double value) {
    low = std::min(low, value);
    high = std::max(high, value);
  }
  std::string text() const {
    constexpr double kMargin = 1.585;  // 10^(1/5)
    return "[" + number_text(low / kMargin, "%.6g") + ":" + number_text(high * kMargin, "%.6g") + "]";
  }
};

}  // namespace

std::string plot_script(const SceneReport& report, PlotFormat format) {
  std::string data, plots;
  Range time, error;
  const auto add_plot = [&](const std::string& plot) { plots += (plots.empty() ? "plot " : ", \\\n  ") + plot; };
  std::size_t colour = 0;
  for (std::size_t i = 0; i < report.curves.size(); ++i) {
    const Curve& curve = report.curves[i];
    if (curve.points.empty()) continue;
    const std::string block = "$curve" + std::to_string(i), style = std::to_string(++colour);
    data += block + " << END\n";
    for (const CurvePoint& point : curve.points) {
      data += number_text(point.time_s, "%.9g") + " " + number_text(std::sqrt(point.mse), "%.9g") + "\n";
      time.include(point.time_s);
      error.include(std::sqrt(point.mse));
    }
    data += "END\n";
    const CurveFit& fit = report.fits[i];
    add_plot(block + " with linespoints lw 2 pt 7 ps 0.7 lc " + style + " title " + quoted(key_text(curve, fit)));
    if (fit.noise > 0 && fit.floor)
      add_plot("[" + number_text(curve.points.front().time_s, "%.9g") + ":" +
               number_text(curve.points.back().time_s, "%.9g") + "] sqrt(" + number_text(fit.noise, "%.9g") + "/x + " +
               number_text(fit.floor_squared, "%.9g") + ") with lines dt 3 lc " + style + " notitle");
  }
  for (std::size_t i = 0; i < report.points.size(); ++i) {
    const GivenPoint& point = report.points[i];
    const std::string block = "$given" + std::to_string(i);
    data += block + " << END\n" + number_text(point.cpu_s, "%.9g") + " " + number_text(point.rmse, "%.9g") + "\nEND\n";
    time.include(point.cpu_s);
    error.include(point.rmse);
    add_plot(block + " with points ps 1.2 lw 1.5 pt " + std::to_string(1 + i % 3) + " lc " + std::to_string(++colour) +
             " title " + quoted(point.label));
  }
  if (plots.empty()) return "";
  return std::string("set terminal ") +
         (format == PlotFormat::svg ? "svg size 800,560 noenhanced background rgb 'white'\n"
                                    : "pngcairo size 1200,840 noenhanced fontscale 1.2\n") +
         "set logscale xy\nset grid\nset key top right opaque box lc rgb '#cccccc'\nset samples 400\n" +
         "set format '%g'\n" + "set title " + quoted(report.scene) +
         "\nset xlabel 'CPU s'\nset ylabel 'RMSE'\nset xrange " + time.text() + "\nset yrange " + error.text() + "\n" +
         data + plots + "\n";
}

}  // namespace tempolux
