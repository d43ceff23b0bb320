// tools/common/tool_main.h -- what all mains share: options, exit codes, messages, statistics, safe outputs.
//
// A main looks like this:
//
//     int main(int argc, char** argv) {
//       tools::Tool tool("photon-trace", "Trace photons through a scene.", argc, argv);
//       std::string scene, output;
//       tool.app().add_option("scene", scene, "glTF scene")->required();
//       tool.output_option(output, "the photons")->required();
//       tool.common_options(tools::uses_scene | tools::uses_seed);
//       return tool.run([&] { ...; return tools::exit_ok; });
//     }
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "tools/common/arguments.h"
#include "tools/common/output.h"
#include "tools/common/stats.h"

namespace CLI {
class App;
class Option;
}  // namespace CLI

namespace tempolux::tools {

enum ExitCode {
  exit_ok = 0,         ///< done, all outputs complete
  exit_differs = 1,    ///< aqm-compare --fail-above, tempolux-info --check and --diff only
  exit_bad_input = 2,  ///< usage, bad or stale input
  exit_cannot = 3,     ///< no memory, disk full, write failed
};

/// What an input is to the run that reads it.
enum class InputRole {
  file,         ///< no output may take its place
  of_scene,     ///< the same; --depfile may name state files instead
  replaceable,  ///< read whole before anything is written: an output may take its place, as in --records c -o c
};

enum CommonOptions : unsigned {
  uses_scene = 1,   ///< --fps --segment --animation --light-units --environment... --volume... --state --allow-stale
                    ///< --allow-outside
  uses_seed = 2,    ///< --seed --seed-mode
  uses_camera = 4,  ///< --camera
  uses_frames = 8,  ///< --frame N or --frames SPEC, into Common::frames
};

/// Media that the command line names; a list has one value for all volumes or one for each.
struct VolumeOptions {
  std::vector<std::string> files;  ///< names or patterns; "none": what the scene names is left out
  std::vector<std::string> grids;
  std::vector<float> sigma_t;  ///< 1/m
  std::vector<std::array<float, 3>> albedo;
  std::vector<float> phase_g;
  std::optional<std::pair<int, int>> frames;  ///< that have files
  std::string majorants;                      ///< file of scene-plan; "": each frame has its own
};

/// Values of the common options.
struct Common {
  int threads = 0;  ///< resolved: >= 1 after parsing
  std::uint64_t seed = 0;
  std::string seed_mode = "fixed";  ///< or "frame": the frame number is mixed into the seed
  std::string camera = "auto";
  std::vector<int> frames{0};  ///< at least one
  double fps = 24;
  int segment_length = 24;
  std::string light_units = "raw";
  std::string animation;    ///< name of the one to play; "": all
  std::string environment;  ///< file; "": none
  std::optional<std::array<float, 3>> environment_color;
  double environment_strength = 1, environment_rotation_deg = 0;
  VolumeOptions volume;
  std::string stats_file, dep_file;      ///< "": none
  std::string said_file;                 ///< warnings that an earlier stage has given, a line each; "": none
  std::vector<std::string> state_files;  ///< listed in the depfile instead of the scene's files
  std::uint64_t max_memory_bytes = 0;    ///< 0: no limit
  int max_texture = 16384;               ///< pixels on a side: larger images are refused
  int reduce_textures = 0;               ///< pixels on a side: larger images are reduced; 0: none
  bool allow_stale = false, allow_outside = false, quiet = false, no_clobber = false;
  int verbose = 0;

  /// The seed for a frame under --seed-mode.
  std::uint64_t seed_for_frame(int frame) const;
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

  /// Adds -o,--output (or another option that names an output, which then stays out of the history).
  CLI::Option* output_option(std::string& path, const std::string& help, const std::string& names = "-o,--output");
  /// Adds an option whose value is a count ("1M"), bytes ("2GiB") or "WIDTHxHEIGHT"; the default shown by
  /// --help is the variable's value.
  CLI::Option* count_option(const std::string& names, std::uint64_t& count, const std::string& help);
  CLI::Option* bytes_option(const std::string& names, std::uint64_t& bytes, const std::string& help);
  CLI::Option* size_option(const std::string& names, int& width, int& height, const std::string& help);
  /// Leaves an option out of history_line(): it does not shape what the output holds.
  void leave_out_of_history(const CLI::Option* option);

  /// Parses, runs, reports. Returns the exit code for main. --stats and --depfile are written when the body
  /// has returned (with 0, or 1 of a comparison), not after an error.
  int run(const std::function<int()>& body);

  Stats& stats();
  /// "tool: message" on standard error unless --quiet; each message once, and not if it stands in the file of --said.
  void warn(const std::string& message);
  /// Only with --verbose.
  void say(const std::string& message);
  /// Progress in [0, 1]: a bar, only on a terminal and after a second. From any thread.
  void progress(double fraction);
  /// This tool's line for an output's history, LF included: version, tool, the options that shape content
  /// and were given, input names without folders. Not --threads, --stats, --depfile, --quiet, --verbose,
  /// --state, outputs. With `frame`, --frames SPEC becomes --frame N and patterns in names are filled, so
  /// that a file says the same whether it was made alone or as one of a range.
  std::string history_line(std::optional<int> frame = {}) const;
  /// Files this run depends on, for --depfile (deduplicated, order kept). With --state, files named here
  /// as part of the scene are left out for the state files. InputError if an output would take the place of one that is
  /// not replaceable: what is read is not destroyed.
  void depends_on(const std::string& file, InputRole role = InputRole::file);
  const std::string& name() const;
  /// Warnings so far, given or not.
  std::vector<std::string> warnings() const;

 private:
  void environment_options();
  void volume_options();

  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace tempolux::tools
