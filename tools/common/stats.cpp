#include "tools/common/stats.h"

#include <sys/resource.h>
#include <sys/time.h>

#include <chrono>
#include <cinttypes>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <fstream>
#include <vector>

#include "lib/core/formatted.h"
#include "lib/core/json.h"
#include "tools/common/output.h"

namespace tempolux::tools {
namespace {

using Json = nlohmann::ordered_json;

/// User and system seconds of all threads of this process since its start, and of child processes that have ended.
double cpu_seconds() {
  double sum = 0;
  for (const auto who : {RUSAGE_SELF, RUSAGE_CHILDREN}) {
    rusage usage = {};
    getrusage(who, &usage);
    for (const timeval t : {usage.ru_utime, usage.ru_stime}) sum += double(t.tv_sec) + 1e-6 * double(t.tv_usec);
  }
  return sum;
}

double wall_seconds() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

/// VmHWM of this program. The fallback ru_maxrss may include the process that started this one.
std::int64_t peak_memory_bytes() {
  std::ifstream status("/proc/self/status");
  for (std::string line; std::getline(status, line);)
    if (std::int64_t kib = 0; std::sscanf(line.c_str(), "VmHWM: %" SCNd64, &kib) == 1) return kib * 1024;
  rusage usage = {};
  getrusage(RUSAGE_SELF, &usage);
  return std::int64_t{usage.ru_maxrss} * 1024;
}

/// Whole numbers are written without a fraction; values that JSON cannot express are null.
Json number(double value) {
  if (!std::isfinite(value)) return nullptr;
  if (value == std::floor(value) && std::abs(value) < 0x1p53) return std::int64_t(value);
  return value;
}

/// Rounds seconds to the microsecond.
double rounded(double seconds) { return std::round(seconds * 1e6) / 1e6; }

}  // namespace

struct Stats::State {
  struct Phase {
    std::string name;
    double cpu_s = 0, wall_s = 0;
    bool parallel = false;
  };
  std::vector<Phase> phases;
  std::size_t open = SIZE_MAX;
  double cpu_at_open = 0, wall_at_open = 0;
  const double wall_at_start = wall_seconds();
  Json counts = Json::object(), results = Json::object();
};

Stats::Stats() : state_(std::make_unique<State>()) {}
Stats::~Stats() = default;

void Stats::phase(const std::string& name, bool parallel) {
  end_phase();
  State& state = *state_;
  std::size_t index = 0;
  while (index < state.phases.size() && state.phases[index].name != name) ++index;
  if (index == state.phases.size()) state.phases.push_back({name, 0, 0, parallel});
  state.open = index;
  state.cpu_at_open = cpu_seconds();
  state.wall_at_open = wall_seconds();
}

void Stats::end_phase() {
  State& state = *state_;
  if (state.open == SIZE_MAX) return;
  state.phases[state.open].cpu_s += cpu_seconds() - state.cpu_at_open;
  state.phases[state.open].wall_s += wall_seconds() - state.wall_at_open;
  state.open = SIZE_MAX;
}

void Stats::count(const std::string& name, double value) {
  const double before = state_->counts.contains(name) ? state_->counts[name].get<double>() : 0.0;
  state_->counts[name] = number(before + value);
}

void Stats::set(const std::string& name, double value) { state_->results[name] = number(value); }

std::string Stats::json(const std::string& tool, const std::string& command, int threads, int exit_code) const {
  Json phases = Json::array();
  for (const State::Phase& phase : state_->phases)
    phases.push_back({{"name", phase.name},
                      {"cpu_s", rounded(phase.cpu_s)},
                      {"wall_s", rounded(phase.wall_s)},
                      {"parallel", phase.parallel}});
  const Json document = {{"schema", "tempolux.stats"},
                         {"version", "1.1"},
                         {"tool", tool},
                         {"tool_version", TEMPOLUX_VERSION},
                         {"command", command},
                         {"host", host_name()},
                         {"exit_code", exit_code},
                         {"threads", threads},
                         {"cpu_s", rounded(cpu_seconds())},
                         {"wall_s", rounded(wall_seconds() - state_->wall_at_start)},
                         {"peak_memory_bytes", peak_memory_bytes()},
                         {"phases", phases},
                         {"counts", state_->counts},
                         {"results", state_->results}};
  return document.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

std::string Stats::summary() const {
  std::string text;
  for (const State::Phase& phase : state_->phases)
    text += (text.empty() ? "" : ", ") + phase.name + formatted(" %.2f s (%.2f CPU s)", phase.wall_s, phase.cpu_s);
  return text;
}

}  // namespace tempolux::tools
