#include "tools/stages/samples.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <functional>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>
#include <sstream>

#include "formats/error.h"

namespace tempolux::tools {
namespace {

namespace fs = std::filesystem;

struct Sample {
  const char* name;
  double scale;   ///< of width and height; its square: of photons
};
constexpr std::array kSamples{Sample{"small", 1.0 / 12}, Sample{"large", 1.0 / 6}};

/// How often each stage runs for the frames asked for.
std::map<std::string, double> runs_by_stage(const Graph& graph) {
  std::set<const GraphFile*> needed;
  std::map<std::string, double> runs;
  const std::function<void(const std::string&)> need = [&](const std::string& name) {
    const GraphFile* file = graph.find(name);
    if (!file || !needed.insert(file).second) return;
    runs[file->stage] += 1;
    for (const std::string& input : file->inputs) need(input);
  };
  for (const auto& [frame, picture] : graph.pictures) need(picture);
  return runs;
}

/// The first frame asked for, and the first that is warped.
std::vector<int> sampled_frames(const Planned& planned) {
  std::vector<int> frames{planned.plan.frames.front()};
  const auto warped = std::ranges::find_if(planned.graph.pictures, [](const auto& shown) { return shown.second.starts_with(stage::walked.folder); });
  if (warped != planned.graph.pictures.end() && warped->first != frames.front()) frames.push_back(warped->first);
  return frames;
}

/// Of one file of a stage, the mean over those in a sample.
struct Cost {
  double fixed_cpu_s = 0, work_cpu_s = 0, bytes = 0;
};

std::optional<Cost> cost_of(const std::string& sample, const StageInfo& stage) {
  std::set<std::string> work;
  std::istringstream names{std::string(stage.work)};
  for (std::string name; std::getline(names, name, ',');) work.insert(name);
  Cost sum;
  double files = 0;
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(sample + "/" + std::string(stage.folder), error)) {
    const bool stats = entry.path().extension() == ".json" && entry.path().stem().extension().empty();
    if (!stats && entry.path().extension() != ".json") sum.bytes += double(entry.file_size());
    if (!stats) continue;
    const nlohmann::json json = nlohmann::json::parse(std::ifstream(entry.path()));
    double in_work = 0;
    for (const auto& phase : json.at("phases"))
      if (work.contains(phase.at("name"))) in_work += phase.at("cpu_s").get<double>();
    sum.work_cpu_s += in_work;
    sum.fixed_cpu_s += std::max(0.0, json.at("cpu_s").get<double>() - in_work);
    files += 1;
  }
  if (files == 0) return std::nullopt;
  return Cost{sum.fixed_cpu_s / files, sum.work_cpu_s / files, sum.bytes / files};
}

}  // namespace

void write_samples(const std::string& folder, Planner& planner, const Wish& wish) {
  const Planned& whole = planner.planned();
  for (const Sample& sample : kSamples) {
    Wish less = wish;
    less.width = std::max(8, int(wish.width * sample.scale));
    less.height = std::max(8, int(wish.height * sample.scale));
    less.report.clear();
    Planned planned = whole;
    planned.plan.frames = sampled_frames(whole);
    for (PlannedSegment& segment : planned.plan.segments)
      segment.decisions.photon_paths = std::max<std::uint64_t>(100, std::uint64_t(double(segment.decisions.photon_paths) * sample.scale * sample.scale));
    planned.graph = planner.graph(planned.plan, less);
    PlanFolder(folder + "/" + sample.name).write(planned, planner.tool_hash(), "", "");
  }
  std::ofstream(folder + "/runs.json") << nlohmann::json(runs_by_stage(whole.graph));
}

std::vector<StageEstimate> estimate_from(const std::string& folder) {
  std::ifstream stream(folder + "/runs.json");
  if (!stream) throw InputError(folder + ": holds no samples; `make -f Makefile.example estimate` makes them");
  const auto runs = nlohmann::json::parse(stream).get<std::map<std::string, double>>();
  std::vector<StageEstimate> estimates;
  const auto [small, large] = kSamples;
  for (const StageInfo& stage : kStages) {
    const auto found = runs.find(std::string(stage.name));
    if (found == runs.end()) continue;
    const std::optional<Cost> a = cost_of(folder + "/" + small.name, stage), b = cost_of(folder + "/" + large.name, stage);
    if (!a || !b) continue;   // it has no statistics
    const auto whole = [&](double in_small, double in_large) { return power_law(small.scale, in_small, large.scale, in_large, 1); };
    estimates.push_back({found->first, found->second, b->fixed_cpu_s + whole(a->work_cpu_s, b->work_cpu_s), whole(a->bytes, b->bytes)});
  }
  return estimates;
}

}  // namespace tempolux::tools
