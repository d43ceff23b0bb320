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

/// Takes "--name value" out of the words; returns the value, or `otherwise` if it is not there.
std::string take(Words& words, const std::string& name, const std::string& otherwise) {
  const auto found = std::find(words.begin(), words.end(), name);
  if (found == words.end() || found + 1 == words.end()) return otherwise;
  const std::string value = found[1];
  words.erase(found, found + 2);
  return value;
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

/// Numbers of the plan that say how often each stage runs.
struct Counts {
  std::set<int> lights, pictures;
  double views = 0;  ///< pictures of one light, mean
  int first = 0, light = 0, second = 0;  ///< the pilot's picture and its light; another picture of that light

  explicit Counts(const Plan& plan) {
    bool begun = false;
    for (const PlannedSegment& segment : plan.segments)
      for (const PlannedFrame& frame : segment.frames) {
        if (!frame.asked) continue;
        if (!begun) first = second = frame.picture, light = frame.lit_frame, begun = true;
        else if (frame.lit_frame == light && second == first) second = frame.picture;
        lights.insert(frame.lit_frame);
        pictures.insert(frame.picture);
      }
    views = double(pictures.size()) / double(std::max<std::size_t>(1, lights.size()));
  }
};

/// The pilots in the order of the pipeline; each adds a stage.
class Pilots {
 public:
  Pilots(const std::string& scene, const Plan& plan, const RunOptions& options)
      : scene_(scene), options_(options), counts_(plan), frame_count_(double(plan.frames.size())) {
    kinds_ = plan.photon_kinds;
    with_points_ = plan.indirect != "paths";
    with_records_ = plan.indirect == "records";
    const Words cache = words_of(options.cache), frames = words_of(options.frames);
    for (const Words& words : {frames, cache})
      if (Words copy = words; std::find(words.begin(), words.end(), "--size") != words.end())
        parse_size(take(copy, "--size", ""), options_.width, options_.height);
    const double shrink = std::max(1.0, std::sqrt(double(options_.width) * options_.height / kPilotPixels));
    width_ = std::max(8, int(options_.width / shrink));
    height_ = std::max(8, int(options_.height / shrink));
  }

  Estimate all() {
    const auto done = [&](double part) {
      if (options_.progress) options_.progress(part);
    };
    if (!kinds_.empty()) {
      photons();
      done(0.1);
      if (with_points_) points();
      done(0.3);
      if (with_records_) records();
      done(0.7);
    }
    frames();
    return estimate_;
  }

 private:
  static constexpr double kPilotPixels = 160 * 90, kPilotPaths = 20'000;

  const std::string scene_;
  RunOptions options_;
  const Counts counts_;
  const double frame_count_;
  std::string kinds_;
  bool with_points_, with_records_;
  int width_ = 0, height_ = 0;
  Folder folder_;
  Estimate estimate_;

  Words common(const std::string& options, int frame) const {
    Words words = words_of(options);
    words.insert(words.begin(), {scene_, "--frames=" + std::to_string(frame)});
    words.insert(words.end(), {"--threads", std::to_string(options_.threads)});
    return words;
  }
  double pixels() const { return double(options_.width) * options_.height; }
  double pilot_pixels() const { return double(width_) * height_; }

  void photons() {
    Words words = common(options_.photons, counts_.light);
    take(words, "--kinds", "");
    const double wanted = double(parse_count(take(words, "--photons", "1M"))), paths = std::min(wanted, kPilotPaths);
    const std::string output = folder_.file("p.photons");
    words.insert(words.end(), {"--photons", std::to_string(std::uint64_t(paths)), "--kinds", kinds_, "-o", output});
    const Cost cost = run(folder_, "photon-trace", words, output);
    estimate_.stages.push_back(
        scaled("photon-trace", double(counts_.lights.size()), pilot_of(cost, {"trace", "commit"}, paths), wanted));
    estimate_.stages.back().work_cpu_s *= options_.moving_cost.light;
    estimate_.stages.back().bytes *= options_.moving_cost.photon_bytes;
  }
  void points() {
    Words words = common(options_.points, counts_.light);
    words.insert(words.begin(), "points");
    const std::string output = folder_.file("p.irradpoints");
    words.insert(words.end(), {"--photons", folder_.file("p.photons"), "-o", output});
    const Cost cost = run(folder_, "irradcache-build", words, output);
    estimate_.stages.push_back(scaled("irradcache-build points", double(counts_.lights.size()),
                                      pilot_of(cost, {"read photons", "points", "write"}, 1), 1));
    estimate_.stages.back().work_cpu_s *= options_.moving_cost.light;
  }
  /// Records for pictures of `width` pixels, of one view or two.
  Cost place(int width, int height, bool both, const std::string& output) {
    Words words = common(options_.cache, counts_.first);
    take(words, "--size", "");
    if (both) words[1] += "," + std::to_string(counts_.second);
    words.insert(words.begin(), "records");
    words.insert(words.end(),
                 {"--points", folder_.file("p.irradpoints"), "--size", size_of(width, height), "-o", output});
    return run(folder_, "irradcache-build", words, output);
  }
  void records() {
    const std::string output = folder_.file("p.irradcache");
    const int half_width = std::max(4, width_ / 2), half_height = std::max(4, height_ / 2);
    const Cost small = place(half_width, half_height, false, output);
    const Cost large = place(width_, height_, false, output);
    const double small_pixels = double(half_width) * half_height;
    const double n1 = small.count("records"), n2 = large.count("records");
    const TwoCosts costs =
        two_costs(n1, small_pixels, small.phases({"records"}), n2, pilot_pixels(), large.phases({"records"}));
    const double first = power_law(half_width, n1, width_, n2, options_.width);
    double others = 0;
    if (counts_.second != counts_.first) {
      const Cost both = place(width_, height_, true, folder_.file("both.irradcache"));
      others = first * std::max(0.0, both.count("records") - n2) / std::max(1.0, n2) * (counts_.views - 1);
    }
    const double wanted = first + others;
    estimate_.stages.push_back({"irradcache-build records", double(counts_.lights.size()),
                                std::max(0.0, large.cpu_s - large.phases({"records"})),
                                (costs.a * wanted + costs.b * pixels() * counts_.views) * options_.moving_cost.records,
                                large.bytes * wanted / std::max(1.0, n2)});
  }
  Cost render(int width, int height, const std::string& output) {
    Words words = common(options_.frames, counts_.first);
    take(words, "--size", "");
    words.insert(words.end(), {"--size", size_of(width, height), "-o", output});
    if (!kinds_.empty() && with_points_) {
      words.insert(words.end(), {"--points", folder_.file("p.irradpoints")});
      if (with_records_) words.insert(words.end(), {"--irradcache", folder_.file("p.irradcache")});
    }
    if (kinds_.find("caustic") != std::string::npos)
      words.insert(words.end(), {"--photons", folder_.file("p.photons")});
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
    StageEstimate frame = scaled("frame-render", double(counts_.pictures.size()), pilot, pixels());
    const double by_width = pilot.work_cpu_s * options_.width / width_;
    frame.work_cpu_s = std::max(by_width, power_law(half_width, small, width_, pilot.work_cpu_s, options_.width));
    estimate_.stages.push_back(frame);
    const double copies = frame_count_ - double(counts_.pictures.size());
    if (copies > 0) estimate_.stages.push_back({"copies of equal frames", copies, 0.002, 0, frame.bytes});
    // Each frame becomes a PNG and is read once more for the sheet.
    const Cost shown = run(folder_, "tempolux-info", {output, "--png", png}, png);
    const PilotRun picture{0.01, std::max(0.0, 2 * (shown.cpu_s - 0.005)), pilot_pixels(), shown.bytes};
    estimate_.stages.push_back(scaled("tempolux-info --png", frame_count_, picture, pixels()));
  }
};

}  // namespace

std::string short_run_stem() {
  std::error_code error;
  const fs::path folder = fs::temp_directory_path(error);
  if (error) throw InputError("TMPDIR names no folder that can be used: " + error.message() + "; set it to one");
  return (folder / (".scene-plan.tmp." + temporary_host() + ".")).string();
}

Estimate estimate_run(const std::string& scene, const Plan& plan, const RunOptions& options) {
  return Pilots(scene, plan, options).all();
}

}  // namespace tempolux::tools
