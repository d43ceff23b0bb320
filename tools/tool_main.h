// tools/tool_main.h -- what all mains share: options, exit codes, messages, statistics, safe outputs.
//
// A main looks like this:
//
//     int main(int argc, char** argv) {
//       tools::Tool tool("photon-trace", "Trace photons through a scene.", argc, argv);
//       std::string scene;
//       tool.app().add_option("scene", scene, "glTF scene")->required();
//       tool.common_options(tools::uses_scene | tools::uses_seed);
//       return tool.run([&] { ...; return tools::exit_ok; });
//     }
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

namespace CLI { class App; }

namespace tempolux::tools {

enum ExitCode {
  exit_ok = 0,          ///< done, all outputs complete
  exit_differs = 1,     ///< aqm-compare --fail-above, tempolux-info --check and --diff only
  exit_bad_input = 2,   ///< usage, bad or stale input
  exit_cannot = 3,      ///< no memory, disk full, write failed
};

enum CommonOptions : unsigned {
  uses_scene = 1,       ///< --camera --fps --segment --light-units --frame --state --allow-stale ...
  uses_seed = 2,        ///< --seed --seed-mode
  uses_camera = 4,
};

/// Values of the common options.
struct Common {
  int threads = 0;                       ///< resolved: >= 1 after parsing
  std::uint64_t seed = 0;
  std::string seed_mode = "fixed";       ///< or "frame": the frame number is mixed into the seed
  std::string camera = "auto";
  double fps = 24;
  int segment_length = 24;
  std::string light_units = "raw";
  std::string stats_file, dep_file;      ///< "": none
  std::vector<std::string> state_files;  ///< listed in the depfile instead of the scene's files
  std::uint64_t max_memory_bytes = 0;    ///< 0: no limit
  bool allow_stale = false, allow_outside = false, quiet = false, no_clobber = false;
  int verbose = 0;

  /// The seed for a frame under --seed-mode.
  std::uint64_t seed_for_frame(int frame) const;
};

/// What a run did, written by --stats as JSON (formats/stats/stats.md).
class Stats {
 public:
  Stats();
  ~Stats();
  /// Starts a phase ("load", "build", "trace", "write" ...); ends the one before. CPU and wall seconds are summed by name.
  void phase(const std::string& name, bool parallel = false);
  void end_phase();
  void count(const std::string& name, double value);          ///< adds to counts.NAME: rays, photons, bytes ...
  void set(const std::string& name, double value);            ///< results.NAME: its own error estimate ...
  void set(const std::string& name, const std::string& value);
  std::string json(const std::string& tool, int exit_code) const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// One program run. Sets flush-to-zero before any thread starts; maps exceptions to one line on standard
/// error and an exit code; removes temporary files when interrupted.
class Tool {
 public:
  Tool(std::string name, std::string what, int argc, char** argv);
  ~Tool();

  CLI::App& app();
  /// Adds --threads --stats --depfile --max-memory --quiet --verbose --no-clobber, and by `flags` the rest.
  void common_options(unsigned flags);
  const Common& common() const;

  /// Parses, runs, reports. Returns the exit code for main.
  int run(const std::function<int()>& body);

  Stats& stats();
  /// "tool: message" on standard error unless --quiet.
  void warn(const std::string& message);
  /// Only with --verbose.
  void say(const std::string& message);
  /// Progress in [0, 1]: a bar, only on a terminal and after a second.
  void progress(double fraction);
  /// This tool's line for an output's history: version, tool, the options that shape content, input names
  /// without folders. Not --threads, --stats, --depfile, --quiet, --verbose, --state, outputs.
  std::string history_line() const;
  /// Files this run depends on, for --depfile (deduplicated, order kept).
  void depends_on(const std::string& file);
  const std::string& name() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// An output under construction: a temporary name in the same folder (".NAME.tmp.HOST.PID"), created at once so that an
/// unwritable place is noticed before the work; commit() syncs and renames. Destroyed uncommitted: removed.
/// "-" is standard output (refused if that is a terminal).
class Output {
 public:
  explicit Output(const std::string& path, bool no_clobber = false);   ///< throws ResourceError
  ~Output();
  Output(Output&&) noexcept;
  const std::string& path() const;        ///< final name
  const std::string& temporary_path() const;  ///< write here; "/dev/stdout" for "-"
  bool is_stdout() const;
  /// Writes bytes through a 1 MiB buffer of its own; throws ResourceError with the reason.
  void write(const void* data, std::size_t size);
  std::ostream& stream();                 ///< the same buffer as a std::ostream
  void commit();                          ///< flush, check, fsync, rename; throws ResourceError

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// Frames of a range: "0-47", "0-47x2", "1,5,9", "9-1" (down). Throws InputError.
std::vector<int> parse_frames(const std::string& text);
/// "f.####.exr" or "f.%04d.exr" with the frame put in; a name without a pattern is returned as it is.
std::string frame_name(const std::string& pattern, int frame);
bool has_frame_pattern(const std::string& pattern);
/// "10k", "1M", "1.5M", "1G", "250000" as a count; "64KiB", "2GiB" as bytes (parse_bytes also takes K, M, G = 1024^n). Throw InputError.
std::uint64_t parse_count(const std::string& text);
std::uint64_t parse_bytes(const std::string& text);
/// "640x360". Throws InputError; each from 1 to 65536.
void parse_size(const std::string& text, int& width, int& height);

}  // namespace tempolux::tools
