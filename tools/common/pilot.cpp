// tools/common/pilot.cpp
#include "tools/common/pilot.h"

#include <spawn.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <functional>
#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>

#include "formats/error.h"
#include "lib/plan/plan_files.h"
#include "tools/common/arguments.h"
#include "tools/common/output.h"
#include "tools/common/temporaries.h"

extern char** environ;

namespace tempolux::tools {
namespace {

namespace fs = std::filesystem;
using Words = std::vector<std::string>;

/// Removed with all that the pilots wrote, by a signal too. Named as left-overs are, for --tidy, and readable by nobody
/// else.
class Folder {
 public:
  Folder() : path_(short_run_stem() + std::to_string(::getpid())), mark_(path_.string()) {
    struct stat there {};   // of a dead process that had our number
    std::error_code ignored;
    if (::lstat(path_.c_str(), &there) == 0 && there.st_uid == ::geteuid()) fs::remove_all(path_, ignored);
    if (::mkdir(path_.c_str(), 0700) == 0) return;
    mark_.release();
    throw ResourceError(path_.string() + ": cannot make a folder for short runs: " + std::strerror(errno) +
                        "; set TMPDIR");
  }
  ~Folder() {
    std::error_code ignored;
    fs::remove_all(path_, ignored);
  }
  std::string file(const std::string& name) const {
    std::string path = (path_ / name).string();
    marks_.try_emplace(name, path);
    return path;
  }

 private:
  fs::path path_;
  Temporary mark_;
  mutable std::map<std::string, Temporary> marks_;
};

Words words_of(const std::string& text) {
  std::istringstream stream(text);
  Words words;
  for (std::string word; stream >> word;) words.push_back(word);
  return words;
}

struct Cost {
  double cpu_s = 0, bytes = 0;
  nlohmann::json stats;
  double phases(const std::set<std::string>& names) const {
    double sum = 0;
    for (const auto& phase : stats.at("phases"))
      if (names.contains(phase.at("name").get<std::string>())) sum += phase.at("cpu_s").get<double>();
    return sum;
  }
  double count(const std::string& name) const { return stats.at("counts").value(name, 0.0); }
};

/// Runs a program of this folder to its end.
Cost run(const Folder& folder, const std::string& tool, Words words, const std::string& output) {
  const std::string program = (fs::read_symlink("/proc/self/exe").parent_path() / tool).string();
  const std::string stats = folder.file("stats.json");
  words.insert(words.begin(), program);
  words.insert(words.end(), {"--quiet", "--stats", stats});
  std::vector<char*> arguments;
  for (std::string& word : words) arguments.push_back(word.data());
  arguments.push_back(nullptr);
  pid_t child = 0;
  if (const int error = posix_spawn(&child, program.c_str(), nullptr, nullptr, arguments.data(), environ))
    throw ResourceError(program + ": cannot be started for a short run: " + std::strerror(error));
  end_together_with(child);
  int status = 0;
  while (waitpid(child, &status, 0) < 0 && errno == EINTR) {
  }
  end_together_with(0);
  if (!WIFEXITED(status) || WEXITSTATUS(status) != 0)
    throw ResourceError(tool + ": its short run for --estimate failed; are its options right?");
  Cost cost;
  cost.stats = nlohmann::json::parse(std::ifstream(stats));
  cost.cpu_s = cost.stats.at("cpu_s").get<double>();
  cost.bytes = double(fs::file_size(output));
  return cost;
}

/// A cost of which these phases are work.
PilotRun pilot_of(const Cost& cost, const std::set<std::string>& work_phases, double work) {
  const double in_work = cost.phases(work_phases);
  return {std::max(0.0, cost.cpu_s - in_work), in_work, work, cost.bytes};
}

std::string size_of(int width, int height) { return std::to_string(width) + "x" + std::to_string(height); }

/// How often each stage runs for the frames asked for.
std::map<std::string, double> runs_by_stage(const Graph& graph) {
  std::map<std::string, const GraphFile*> maker;
  for (const GraphFile& file : graph.files) {
    maker[file.name] = &file;
    for (const std::string& name : file.beside) maker[name] = &file;
  }
  std::set<const GraphFile*> needed;
  const std::function<void(const std::string&)> need = [&](const std::string& name) {
    const auto found = maker.find(name);
    if (found == maker.end() || !needed.insert(found->second).second) return;
    for (const std::string& input : found->second->inputs) need(input);
  };
  for (const auto& [frame, picture] : graph.pictures) need(picture);
  std::map<std::string, double> runs;
  for (const GraphFile* file : needed) runs[file->stage] += 1;
  return runs;
}

/// What one file of each stage costs, from pilots of the first picture in the order of the pipeline.
class Pilots {
 public:
  Pilots(const std::string& scene, const Planned& planned, const Wish& wish, Tool& tool)
      : scene_(scene), planned_(planned), wish_(wish), tool_(tool), runs_(runs_by_stage(planned.graph)),
        shown_(planned.plan.shows.at(planned.plan.frames.front())), segment_(planned.plan.segment_of(shown_)), decided_(segment_.decisions) {
    shown_ = segment_.at(shown_).picture;
    lit_ = segment_.at(shown_).lit_frame;
    const double shrink = std::max(1.0, std::sqrt(double(wish.width) * wish.height / kPilotPixels));
    width_ = std::max(8, int(wish.width / shrink));
    height_ = std::max(8, int(wish.height / shrink));
  }

  Estimate all() {
    if (decided_.photons()) {
      photons();
      tool_.progress(0.1);
      if (decided_.points()) points();
      tool_.progress(0.3);
      if (decided_.records()) records();
      tool_.progress(0.7);
    }
    frames();
    return estimate_;
  }

 private:
  static constexpr double kPilotPixels = 160 * 90, kPilotPaths = 20'000;

  Words common(const std::string& words, int frame) const {
    Words all{scene_, "--frames=" + std::to_string(frame), "--threads", std::to_string(tool_.common().threads)};
    for (const Words& more : {words_of(words), shared_arguments(tool_.common())}) all.insert(all.end(), more.begin(), more.end());
    return all;
  }
  double pixels() const { return double(wish_.width) * wish_.height; }
  double pilot_pixels() const { return double(width_) * height_; }
  /// Adds a stage that runs; `share`: of the work of the pilot's stage.
  void add(const StageInfo& stage, const StageEstimate& one, double share = 1) {
    const auto runs = runs_.find(std::string(stage.name));
    if (runs == runs_.end()) return;
    estimate_.stages.push_back({std::string(stage.name), runs->second, one.fixed_cpu_s, one.work_cpu_s * share, one.bytes});
  }
  /// Where light follows from that of what stands, a pilot's cost is spread over the states; what stands costs a state in full.
  double moved_share(double cost, const StageInfo& stands, const StageInfo& states) const {
    const auto count = [&](const StageInfo& stage) { const auto found = runs_.find(std::string(stage.name)); return found == runs_.end() ? 0.0 : found->second; };
    return decided_.moving == MovingMethod::anew ? 1 : std::max(0.1, cost - count(stands) / std::max(1.0, count(states)));
  }

  void photons() {
    const double wanted = double(decided_.photon_paths), paths = std::min(wanted, kPilotPaths);
    const std::string output = folder_.file("p.photons");
    Words words = common("", lit_);
    words.insert(words.end(), {"--photons", std::to_string(std::uint64_t(paths)), "--kinds", decided_.kinds, "-o", output});
    const StageEstimate one = scaled("", 1, pilot_of(run(folder_, "photon-trace", words, output), {"trace", "commit"}, paths), wanted);
    add(stage::stands_photons, one);
    add(stage::photons, one);
    StageEstimate moved = one;
    moved.bytes *= decided_.moving_cost.photon_bytes;
    add(stage::moved_photons, moved, moved_share(decided_.moving_cost.light, stage::stands_photons, stage::moved_photons));
  }
  void points() {
    const std::string output = folder_.file("p.irradpoints");
    Words words = common(wish_.points, lit_);
    words.insert(words.begin(), "points");
    words.insert(words.end(), {"--photons", folder_.file("p.photons"), "-o", output});
    const StageEstimate one = scaled("", 1, pilot_of(run(folder_, "irradcache-build", words, output), {"read photons", "points", "write"}, 1), 1);
    add(stage::stands_points, one);
    add(stage::points, one, moved_share(decided_.moving_cost.light, stage::stands_points, stage::points));
    add(stage::split, {"", 1, 0.02, 0.02 * one.work_cpu_s, one.bytes});
  }
  /// Records for pictures of `width` pixels, of one view or two.
  Cost place(int width, int height, int second, const std::string& output) {
    Words words = common(wish_.records, shown_);
    if (second != shown_) words[1] += "," + std::to_string(second);
    words.insert(words.begin(), "records");
    words.insert(words.end(), {"--camera", wish_.camera, "--points", folder_.file("p.irradpoints"), "--size", size_of(width, height), "-o", output});
    if (wish_.records.find("--rays") == std::string::npos) words.insert(words.end(), {"--rays", std::to_string(decided_.record_rays)});
    return run(folder_, "irradcache-build", words, output);
  }
  void records() {
    const std::string output = folder_.file("p.irradcache");
    const int half_width = std::max(4, width_ / 2), half_height = std::max(4, height_ / 2);
    const Cost small = place(half_width, half_height, shown_, output);
    const Cost large = place(width_, height_, shown_, output);
    const double small_pixels = double(half_width) * half_height;
    const double n1 = small.count("records"), n2 = large.count("records");
    const TwoCosts costs = two_costs(n1, small_pixels, small.phases({"records"}), n2, pilot_pixels(), large.phases({"records"}));
    const double first = power_law(half_width, n1, width_, n2, wish_.width);
    const std::vector<int> pictures = segment_.pictures(lit_);
    double others = 0;
    if (pictures.size() > 1) {
      const int second = pictures.front() == shown_ ? pictures[1] : pictures.front();
      const Cost both = place(width_, height_, second, folder_.file("both.irradcache"));
      others = first * std::max(0.0, both.count("records") - n2) / std::max(1.0, n2) * double(pictures.size() - 1);
    }
    const double wanted = first + others;
    const StageEstimate one{"", 1, std::max(0.0, large.cpu_s - large.phases({"records"})),
                            costs.a * wanted + costs.b * pixels() * double(pictures.size()), large.bytes * wanted / std::max(1.0, n2)};
    add(stage::stands_records, one);
    const bool over_time = decided_.moving == MovingMethod::time;
    add(stage::records, one, over_time ? 1 : moved_share(decided_.moving_cost.records, stage::stands_records, stage::records));
    add(stage::kept, one, decided_.moving_cost.records);
  }
  Cost render(int width, int height, const std::string& output) {
    Words words = common(wish_.pixels, shown_);
    words.insert(words.end(), {"--camera", wish_.camera, "--channels", wish_.channels, "--size", size_of(width, height), "-o", output});
    if (!decided_.learn_lights) std::erase(words, "--learn-lights");
    if (decided_.points()) words.insert(words.end(), {"--points", folder_.file("p.irradpoints")});
    if (decided_.records()) words.insert(words.end(), {"--irradcache", folder_.file("p.irradcache")});
    if (decided_.caustic_map) words.insert(words.end(), {"--photons", folder_.file("p.photons")});
    return run(folder_, "frame-render", words, output);
  }
  /// A larger picture has less to see in each pixel, which then needs fewer samples: its time grows more slowly than
  /// its pixels, though never slower than its width.
  void frames() {
    const std::string output = folder_.file("p.exr"), png = folder_.file("p.png");
    const int half_width = std::max(4, width_ / 2), half_height = std::max(4, height_ / 2);
    const std::set<std::string> work{"render", "data channels", "write"};
    const double small = render(half_width, half_height, output).phases(work);
    const Cost cost = render(width_, height_, output);
    const PilotRun pilot = pilot_of(cost, work, pilot_pixels());
    StageEstimate frame = scaled("", 1, pilot, pixels());
    const double by_width = pilot.work_cpu_s * wish_.width / width_;
    frame.work_cpu_s = std::max(by_width, power_law(half_width, small, width_, pilot.work_cpu_s, wish_.width));
    // Shares of a whole frame's work, as measured on S4: rays of masked pixels, two samples a pixel, and the filter.
    for (const auto& [stage, share] : {std::pair{stage::lights, 0.1}, {stage::keys, 1.0}, {stage::walk, 0.1}, {stage::walked, 0.25}, {stage::raw, 0.3},
                                       {stage::filtered, 0.1}, {stage::pictures, 1.0}, {stage::smoke, 0.3}})
      add(stage, frame, share);
    const double frame_count = double(planned_.plan.frames.size());
    estimate_.stages.push_back({"copies of pictures", frame_count, 0.002, 0, frame.bytes});
    // Each frame becomes a PNG and is read once more for the sheet.
    const Cost shown = run(folder_, "tempolux-info", {output, "--png", png}, png);
    const PilotRun picture{0.01, std::max(0.0, 2 * (shown.cpu_s - 0.005)), pilot_pixels(), shown.bytes};
    estimate_.stages.push_back(scaled("tempolux-info --png", frame_count, picture, pixels()));
  }

  const std::string scene_;
  const Planned& planned_;
  const Wish& wish_;
  Tool& tool_;
  std::map<std::string, double> runs_;
  int shown_, lit_ = 0;
  const PlannedSegment& segment_;
  const Decisions& decided_;
  int width_ = 0, height_ = 0;
  Folder folder_;
  Estimate estimate_;
};

}  // namespace

std::string short_run_stem() {
  std::error_code error;
  const fs::path folder = fs::temp_directory_path(error);
  if (error) throw InputError("TMPDIR names no folder that can be used: " + error.message() + "; set it to one");
  return (folder / (".scene-plan.tmp." + temporary_host() + ".")).string();
}

Estimate estimate_run(const std::string& scene, const Planned& planned, const Wish& wish, Tool& tool) {
  return Pilots(scene, planned, wish, tool).all();
}

}  // namespace tempolux::tools
