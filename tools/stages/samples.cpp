#include "tools/stages/samples.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <functional>
#include <optional>
#include <set>

#include "formats/error.h"
#include "lib/core/json.h"
#include "lib/core/json_file.h"
#include "lib/plan/graph_builder.h"

namespace tempolux::tools {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr double kWidth = 128;  ///< width in pixels of the larger sample, at most half of the picture's
constexpr int kFewerRays = 4;   ///< of a record
constexpr std::array kSamples{"small", "large"};

/// How often a stage runs for the requested frames. work, bytes: sums over these runs of the work and the bytes of a
/// run over the work and the bytes of a sample. The size of the picture is left out; a power law takes it into account.
struct Runs {
  double count = 0, work = 0, bytes = 0;
};

std::map<std::string, Runs> runs_by_stage(const Planned& whole, double photons, double rays) {
  const Decisions& d = whole.plan.segment_of(whole.plan.shows.at(whole.plan.frames.front())).decisions;
  std::set<const GraphFile*> needed;
  std::map<std::string, Runs> runs;
  const std::function<void(const std::string&)> need = [&](const std::string& name) {
    const GraphFile* file = whole.graph.find(name);
    if (!file || !needed.insert(file).second) return;
    const bool records = file->name.ends_with(".irradcache");
    // The options of records list the frames whose cameras share them, separated by commas.
    const double bytes = file->name.ends_with(".photons") ? photons
                         : records ? d.records_of(1 + double(std::ranges::count(file->words, ',')))
                                   : 1;
    Runs& stage = runs[std::string(file->stage->name)];
    stage.count += 1;
    stage.work += bytes * (records ? rays : 1);
    stage.bytes += bytes;
    for (const std::string& input : file->inputs) need(input);
  };
  for (const auto& [frame, picture] : whole.graph.pictures) need(picture);
  return runs;
}

/// The first requested frame, and the first warped frame.
std::vector<int> sampled_frames(const Planned& planned) {
  std::vector<int> frames{planned.plan.frames.front()};
  const auto warped = std::ranges::find_if(
      planned.graph.pictures, [](const auto& shown) { return shown.second.starts_with(stage_in("walked").folder); });
  if (warped != planned.graph.pictures.end() && warped->first != frames.front()) frames.push_back(warped->first);
  return frames;
}

/// Mean cost of one file of a stage in a sample.
struct Cost {
  double fixed_cpu_s = 0, work_cpu_s = 0, bytes = 0;
  double memory = 0;  ///< largest of its processes, bytes
};

/// The statistics of the processes that have made a file. A warped frame is warped and completed.
std::vector<std::string> stats_of(const std::string& folder, const std::string& file) {
  std::vector<std::string> found;
  for (const char* end : {".json", ".warp.json"})
    if (std::string stats = folder + "/" + beside(file, end); fs::exists(stats)) found.push_back(std::move(stats));
  return found;
}

/// `files`: names of the files in `folder` that each command of the stage writes. Some may not have been needed, as
/// keys in the middle of an interval that was not halved. Empty if none has statistics.
std::optional<Cost> cost_of(const std::string& folder, const StageInfo& stage,
                            const std::vector<std::vector<std::string>>& files) {
  Cost sum;
  double count = 0;
  for (const std::vector<std::string>& names : files) {
    const std::vector<std::string> processes = stats_of(folder, names.front());
    if (processes.empty()) continue;
    ++count;
    for (const std::string& stats : processes) {
      const Json json = read_json(stats);
      double in_work = 0;
      for (const auto& phase : json.at("phases"))
        if (has_channel(std::string(stage.work), phase.at("name"))) in_work += phase.at("cpu_s").get<double>();
      sum.memory = std::max(sum.memory, json.at("peak_memory_bytes").get<double>());
      sum.work_cpu_s += in_work;
      sum.fixed_cpu_s += std::max(0.0, json.at("cpu_s").get<double>() - in_work);
    }
    for (const std::string& name : names)
      if (fs::exists(folder + "/" + name)) sum.bytes += double(fs::file_size(folder + "/" + name));
  }
  return count == 0
             ? std::nullopt
             : std::optional(Cost{sum.fixed_cpu_s / count, sum.work_cpu_s / count, sum.bytes / count, sum.memory});
}

/// The rest of the CPU seconds of make, for each command of a stage: shells, make, previews and the sheet. FOLDER/made
/// has the CPU seconds of all processes of both samples. They share files that do not depend on the size.
double rest_of(const std::string& folder, const Json& samples) {
  std::set<std::string> commands;
  double rest = 0;
  std::ifstream(folder + "/made") >> rest;
  for (const char* sample : kSamples)
    for (const auto& [stage, files] : samples.at(sample).items())
      for (const std::vector<std::string> names : files)
        for (const std::string& stats : stats_of(folder, names.front()))
          if (commands.insert(stats).second) rest -= read_json(stats).at("cpu_s").get<double>();
  return commands.empty() ? 0 : std::max(0.0, rest) / double(commands.size());
}

}  // namespace

void write_samples(const std::string& folder, Planner& planner, const Wish& wish) {
  const Planned& whole = planner.planned();
  const double large = std::min(0.5, kWidth / wish.width);
  Json json = {{"scales", {large / 2, large}}, {"size", {wish.width, wish.height}}};
  PlanFolder out(folder);
  for (std::size_t i = 0; i < kSamples.size(); ++i) {
    const double scale = json["scales"][i];
    Wish less = wish;
    less.width = std::max(8, int(wish.width * scale));
    less.height = std::max(8, int(wish.height * scale));
    less.report.clear();
    Planned planned = whole;
    planned.plan.frames = sampled_frames(whole);
    for (PlannedSegment& segment : planned.plan.segments) {
      Decisions& d = segment.decisions;
      d.photon_paths = std::max<std::uint64_t>(100, std::uint64_t(double(d.photon_paths) * large * large));
      d.record_rays = std::max(1, d.record_rays / kFewerRays);
      d.together = 1;
    }
    planned.graph = planner.graph(planned.plan, less);
    out.write(planned, planner.tool_hash(), "", "");
    fs::rename(folder + "/plan.mk", folder + "/" + kSamples[i] + ".mk");
    for (const GraphFile& file : planned.graph.files) {
      std::vector<std::string> names{file.name};
      names.insert(names.end(), file.beside.begin(), file.beside.end());
      json[kSamples[i]][file.stage->name].push_back(names);
    }
  }
  // If the wish sets --rays, the records of a sample have as many rays as those of the whole run.
  const double rays = has_word(wish.records, "--rays") ? 1 : kFewerRays;
  for (const auto& [stage, runs] : runs_by_stage(whole, 1 / (large * large), rays))
    json["runs"][stage] = {runs.count, runs.work / runs.count, runs.bytes / runs.count};
  for (const auto& [frame, picture] : whole.graph.pictures)
    if (const GraphFile* file = whole.graph.find(picture)) {
      Json& shown = json["shown"][std::string(file->stage->name)];
      shown = shown.is_null() ? 1 : shown.get<int>() + 1;
    }
  for (const GraphFile& file : whole.graph.files)
    if (file.passing) json["passing"][std::string(file.stage->name)] = true;
  std::ofstream(folder + "/samples.json") << json;
}

std::vector<StageEstimate> estimate_from(const std::string& folder) {
  if (!fs::exists(folder + "/samples.json"))
    throw InputError(folder + ": holds no samples; `make -f Makefile.example estimate` makes them");
  const Json json = read_json(folder + "/samples.json");
  Json costs = {{"size", json.at("size")}};
  const Json planned = read_json(folder + "/planned.json");
  std::vector<StageEstimate> estimates{{"scene-plan", 1, planned.at("cpu_s")}};
  double commands = 0;
  for (const StageInfo& stage : kStages) {
    const std::string name(stage.name);
    if (!json.at("runs").contains(name)) continue;
    const auto cost = [&](const char* sample) {
      return cost_of(folder, stage, json.at(sample).value(name, std::vector<std::vector<std::string>>{}));
    };
    const std::optional<Cost> a = cost(kSamples[0]), b = cost(kSamples[1]);
    if (!a || !b) continue;
    const std::array<double, 3> runs = json.at("runs").at(name);
    const auto whole = [&](double in_small, double in_large) {
      return power_law(json.at("scales")[0], in_small, json.at("scales")[1], in_large, 1);
    };
    estimates.push_back({name, runs[0], b->fixed_cpu_s + runs[1] * whole(a->work_cpu_s, b->work_cpu_s),
                         runs[2] * whole(a->bytes, b->bytes), json.at("shown").value(name, 0.0),
                         json.value("passing", Json::object()).contains(name)});
    costs["stages"][std::string(stage.folder)] = {estimates.back().cpu_s,
                                                  std::max(b->memory, whole(a->memory, b->memory))};
    commands += runs[0];
  }
  const double rest = rest_of(folder, json);
  estimates.push_back({"make, previews, sheet: a command", commands, rest});
  costs["plan"] = planned.at("cpu_s");
  costs["rest"] = rest;
  std::ofstream(folder + "/costs.json") << costs;
  return estimates;
}

}  // namespace tempolux::tools
