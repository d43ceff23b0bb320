// tools/common/stats.h -- the figures and costs of a run, which --stats writes as JSON (formats/stats/stats.md).
#pragma once

#include <memory>
#include <string>

namespace tempolux::tools {

/// Only for the main thread.
class Stats {
 public:
  Stats();
  ~Stats();
  /// Starts a phase ("load", "build", "trace", "write" ...) and ends the one before. CPU and wall seconds are summed by
  /// name, so a phase may recur for each frame.
  void phase(const std::string& name, bool parallel = false);
  void end_phase();
  void count(const std::string& name, double value);  ///< adds to counts.NAME: rays, photons, bytes ...
  void set(const std::string& name, double value);    ///< sets results.NAME, for example an error estimate

  /// The text of the file. `command` is the tool's line of history.
  std::string json(const std::string& tool, const std::string& command, int threads, int exit_code) const;
  /// "trace 1.93 s (3.81 CPU s)" for each phase, for --verbose.
  std::string summary() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace tempolux::tools
