// lib/plan/estimate.cpp
#include "lib/plan/estimate.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>

namespace tempolux {
namespace {

template <class... Values>
std::string line(const char* format, Values... values) {
  std::array<char, 200> text{};
  std::snprintf(text.data(), text.size(), format, values...);
  return text.data();
}

std::string size_text(double bytes) {
  if (bytes >= 1e9) return line("%.1f GB", bytes / 1e9);
  if (bytes >= 1e6) return line("%.1f MB", bytes / 1e6);
  return line("%.0f kB", std::ceil(bytes / 1e3));
}

double wall_of(const StageEstimate& stage, int processors, int jobs, int threads) {
  const double at_once = std::max(1.0, std::min(double(jobs), stage.runs)), lanes = std::max(1, threads);
  const double alone = stage.fixed_cpu_s + stage.work_cpu_s / std::min(lanes, double(std::max(1, processors)));
  const double shared = stage.cpu_s() / std::max(1, processors);
  return std::max(shared, stage.runs * alone / at_once);
}

}  // namespace

StageEstimate scaled(const std::string& stage, double runs, const PilotRun& pilot, double work) {
  const double factor = work / pilot.work;
  return {stage, runs, pilot.fixed_cpu_s, pilot.work_cpu_s * factor, pilot.bytes * factor};
}

double power_law(double x1, double y1, double x2, double y2, double x) {
  if (y2 <= 0) return 0;
  const double exponent = y1 > 0 ? std::clamp(std::log(y2 / y1) / std::log(x2 / x1), 0.0, 2.0) : 1.0;
  return y2 * std::pow(x / x2, exponent);
}

TwoCosts two_costs(double m1, double n1, double t1, double m2, double n2, double t2) {
  const double determinant = m1 * n2 - m2 * n1;
  if (std::abs(determinant) > 1e-6 * std::abs(m2 * n2)) {
    const TwoCosts costs{(t1 * n2 - t2 * n1) / determinant, (m1 * t2 - m2 * t1) / determinant};
    if (costs.a >= 0 && costs.b >= 0) return costs;
    if (costs.a < 0 && n2 > 0) return {0, t2 / n2};
  }
  return m2 > 0 ? TwoCosts{t2 / m2, 0} : TwoCosts{0, n2 > 0 ? t2 / n2 : 0};
}

double Estimate::cpu_s() const {
  double sum = 0;
  for (const StageEstimate& stage : stages) sum += stage.cpu_s();
  return sum;
}

double Estimate::bytes() const {
  double sum = 0;
  for (const StageEstimate& stage : stages) sum += stage.total_bytes();
  return sum;
}

double Estimate::wall_s(int processors, int jobs, int threads) const {
  double sum = 0;
  for (const StageEstimate& stage : stages) sum += wall_of(stage, processors, std::max(1, jobs), threads);
  return sum;
}

std::string estimate_text(const Estimate& estimate, int processors, int jobs, int threads) {
  std::string text = "stage                     runs  CPU s each   CPU s all   file each       files\n";
  for (const StageEstimate& stage : estimate.stages)
    text += line("%-24s %5.0f %11.3f %11.1f %11s %11s\n", stage.stage.c_str(), stage.runs,
                 stage.fixed_cpu_s + stage.work_cpu_s, stage.cpu_s(), size_text(stage.bytes).c_str(),
                 size_text(stage.total_bytes()).c_str());
  return text + line("%-24s %29.1f %23s\n", "all", estimate.cpu_s(), size_text(estimate.bytes()).c_str()) +
         line("about %.0f s with %d processor%s, %d job%s at a time of %d thread%s\n",
              std::ceil(estimate.wall_s(processors, jobs, threads)), processors, processors == 1 ? "" : "s", jobs,
              jobs == 1 ? "" : "s", threads, threads == 1 ? "" : "s");
}

std::string estimate_json(const Estimate& estimate, int processors, int jobs, int threads) {
  nlohmann::ordered_json json = {{"cpu_s", estimate.cpu_s()},
                                 {"wall_s", estimate.wall_s(processors, jobs, threads)},
                                 {"bytes", std::round(estimate.bytes())},
                                 {"processors", processors},
                                 {"jobs", jobs},
                                 {"threads", threads}};
  json["stages"] = nlohmann::ordered_json::array();
  for (const StageEstimate& stage : estimate.stages)
    json["stages"].push_back({{"stage", stage.stage},
                              {"runs", stage.runs},
                              {"cpu_s_each", stage.fixed_cpu_s + stage.work_cpu_s},
                              {"cpu_s", stage.cpu_s()},
                              {"bytes_each", std::round(stage.bytes)},
                              {"bytes", std::round(stage.total_bytes())}});
  return json.dump(1) + "\n";
}

}  // namespace tempolux
