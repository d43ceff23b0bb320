// lib/plan/estimate.cpp -- estimates the cost of a run.
#include "lib/plan/estimate.h"

#include <algorithm>
#include <cmath>

#include "lib/core/formatted.h"

namespace tempolux {
namespace {

std::string size_text(double bytes) {
  if (bytes >= 1e9) return formatted("%.1f GB", bytes / 1e9);
  if (bytes >= 1e6) return formatted("%.1f MB", bytes / 1e6);
  return formatted("%.0f kB", std::ceil(bytes / 1e3));
}

std::string time_text(double seconds) {
  if (seconds >= 2 * 3600) return formatted("%.1f hours", seconds / 3600);
  if (seconds >= 120) return formatted("%.0f minutes", seconds / 60);
  return formatted("%.0f s", std::ceil(seconds));
}

}  // namespace

StageCosts table_costs(int width, int height) {
  const double pixels = double(width) * height / (640 * 360);
  StageCosts costs;
  for (const StageInfo& stage : kStages) {
    const bool draws = stage.part != Part::photons && stage.part != Part::points;
    costs[std::string(stage.folder)] = {stage.cpu_s * (draws ? pixels : 1),
                                        stage.memory_mb * 1e6 * (draws ? std::max(1.0, pixels) : 1)};
  }
  return costs;
}

double power_law(double x1, double y1, double x2, double y2, double x) {
  if (y2 <= 0) return 0;
  const double exponent = y1 > 0 ? std::clamp(std::log(y2 / y1) / std::log(x2 / x1), 0.0, 2.0) : 1.0;
  return y2 * std::pow(x / x2, exponent);
}

std::string estimate_text(const std::vector<StageEstimate>& stages, int processors) {
  std::string text = "stage                                 runs  CPU s each   CPU s all   file each       files\n";
  double cpu_s = 0, bytes = 0, frames = 0, passing = 0;
  for (const StageEstimate& stage : stages) {
    cpu_s += stage.runs * stage.cpu_s;
    if (stage.passing) passing = std::max(passing, stage.bytes);
    else bytes += stage.runs * stage.bytes;
    frames += stage.shown * stage.bytes;
    text += formatted("%-36s %5.0f %11.3f %11.1f %11s %11s\n", stage.stage.c_str(), stage.runs, stage.cpu_s,
                      stage.runs * stage.cpu_s, size_text(stage.bytes).c_str(),
                      stage.passing ? "removed" : size_text(stage.runs * stage.bytes).c_str());
  }
  return text + formatted("%-36s %29.1f %23s\n", "all", cpu_s, size_text(bytes).c_str()) + "about " +
         time_text(cpu_s / processors) + " on " + std::to_string(processors) +
         (processors == 1 ? " processor\n" : " processors\n") + "disk: at most " +
         size_text(bytes + frames + 2 * processors * passing) + " with frames and what is removed later\n";
}

}  // namespace tempolux
