// tools/common/tool_main.h -- shared by all mains: options, exit codes, messages, statistics, safe outputs.
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
#include <limits>
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
  exit_differs = 1,    ///< aqm-compare --fail-above, tempolux-info --check, --whole and --diff only
  exit_bad_input = 2,  ///< usage, bad or stale input
  exit_cannot = 3,     ///< no memory, disk full, write failed
};

/// How a run uses an input file.
enum class InputRole {
  file,  ///< no output may replace it
  /// The tool reads the file completely before it writes anything. So an output may replace the file, as in
  /// frame-render --base f.exr -o f.exr.
  replaceable,
};

/// For number_option: any finite number from `least` on.
inline constexpr double kNoLimit = std::numeric_limits<double>::infinity();

enum CommonOptions : unsigned {
  uses_scene = 1,       ///< --fps --segment --animation --light-units --environment... --volume... --allow-stale
  uses_seed = 2,        ///< --seed --seed-mode
  uses_camera = 4,      ///< --camera --f-stop --lens-radius --focus --sensor-width --shutter --shutter-open
  uses_frames = 8,      ///< --frame N or --frames SPEC, into Common::frames
  uses_majorants = 16,  ///< --majorants; only with uses_scene
};

/// Media that the command line names. A list has one value for all volumes, or one for each.
struct VolumeOptions {
  std::vector<std::string> files;  ///< FILE.vdb or FILE.vdb:GRID; "none": without the media that the scene names
  std::vector<float> sigma_t;      ///< 1/m
  std::vector<std::array<float, 3>> albedo;
  std::vector<float> phase_g;
  std::optional<std::pair<int, int>> frames;  ///< frames that have files
  std::string up = "y";                       ///< axis of the files that points up: y or z
  std::string majorants;                      ///< file from scene-plan; "": each frame has its own majorants
};

/// Options of the camera's lens and shutter. A given option replaces the scene's value; an empty one keeps it.
struct LensOptions {
  std::optional<double> f_stop, radius_m, sensor_width_mm;
  std::string focus;  ///< metres, or the name of a node
  std::optional<double> shutter_deg;
  std::string shutter_open;  ///< centre or begin
};

/// Values of the common options.
struct Common {
  int threads = 0;  ///< after parsing at least 1
  std::uint64_t seed = 0;
  std::string seed_mode = "fixed";  ///< or "frame": the frame number is mixed into the seed
  std::string camera = "auto";
  LensOptions lens;
  std::vector<int> frames{0};  ///< at least one
  double fps = 24;
  int segment_length = 24;
  std::string light_units = "raw";
  std::string animation;    ///< name of the animation to play; "": all
  std::string environment;  ///< file or R,G,B; "": none
  double environment_strength = 1, environment_rotation_deg = 0;
  VolumeOptions volume;
  std::string stats_file, dep_file;    ///< "": none
  std::uint64_t max_memory_bytes = 0;  ///< 0: no limit
  bool allow_stale = false, quiet = false;
  int verbose = 0;

  /// The seed for a frame under --seed-mode.
  std::uint64_t seed_for_frame(int frame) const;
};

/// One program run. Sets flush-to-zero before any thread starts; turns exceptions into one line on standard error and
/// an exit code; removes temporary files when interrupted.
class Tool {
 public:
  Tool(std::string name, std::string what, int argc, char** argv);
  ~Tool();

  CLI::App& app();
  /// Adds --threads --stats --depfile --max-memory --quiet --verbose, and the options selected by `flags`.
  void common_options(unsigned flags);
  const Common& common() const;

  /// Adds -o,--output (or another option that names an output); history lines do not contain it.
  CLI::Option* output_option(std::string& path, const std::string& help, const std::string& names = "-o,--output");
  /// Adds an option whose value is the name of a file, or a pattern of names for the frames of a range.
  CLI::Option* file_option(const std::string& names, std::string& file, const std::string& help);
  CLI::Option* file_option(const std::string& names, std::vector<std::string>& files, const std::string& help);
  /// Adds an option whose value is one of `words`; help shows the default.
  CLI::Option* choice_option(const std::string& names, std::string& word, const std::vector<std::string>& words,
                             const std::string& help);
  /// Adds an option whose value is a list of words, separated by commas; help shows the default.
  CLI::Option* list_option(const std::string& names, std::vector<std::string>& words, const std::string& help);
  /// Adds an option whose value is a number from `least` to `most`; Number is int, float or double.
  template <class Number>
  CLI::Option* number_option(const std::string& names, Number& number, double least, double most,
                             const std::string& help);
  /// Adds an option whose value is a number between `least` and `most`, both excluded, or the word auto: no number.
  CLI::Option* auto_option(const std::string& names, std::optional<double>& number, double least, double most,
                           const std::string& help);
  /// Adds an option whose value is a count ("1M"), bytes ("2GiB") or "WIDTHxHEIGHT"; the default shown by
  /// --help is the variable's value.
  CLI::Option* count_option(const std::string& names, std::uint64_t& count, const std::string& help);
  CLI::Option* bytes_option(const std::string& names, std::uint64_t& bytes, const std::string& help);
  CLI::Option* size_option(const std::string& names, int& width, int& height, const std::string& help);
  /// Leaves an option out of history_line(), because it does not affect the output's content; returns the option.
  CLI::Option* leave_out_of_history(CLI::Option* option);

  /// Throws InputError if the run has several frames and a name has no pattern for their numbers; skips empty names.
  void check_patterns(const std::vector<std::string>& names) const;
  /// The same for the name of an EXR output, which cannot be standard output.
  void check_frame_output(const std::string& name) const;

  /// Parses, runs and reports. Returns the exit code for main. --stats and --depfile are written if the body returned
  /// 0, or 1 from a comparison, but not after an error.
  int run(const std::function<int()>& body);

  Stats& stats();
  /// "tool: message" on standard error unless --quiet; each message once, and not if the file TEMPOLUX_SAID has it.
  void warn(const std::string& message);
  /// Refuses an input that was made for another state of the scene: throws InputError, which ends with `remedy` and
  /// names --allow-stale. With --allow-stale only warns.
  void refuse_stale(const std::string& message, const std::string& remedy);
  /// "tool: message" on standard error with --verbose, unless --quiet.
  void say(const std::string& message);
  /// Shows progress in [0, 1] as a bar; only on a terminal and after a second. Any thread may call.
  void progress(double fraction);
  /// progress() as a function; valid as long as the tool.
  std::function<void(double)> progress_sink();
  /// This tool's line for an output's history, with a line feed: version, tool, the given options that affect content,
  /// and input names without folders.
  /// With `frame`, --frames SPEC becomes --frame N and patterns in names are filled in, so that a file has the same
  /// history whether it was made alone or in a range.
  std::string history_line(std::optional<int> frame = {}) const;
  /// The given options that every tool needs to read this scene in the same way: time, lights, media. Names of files
  /// are absolute.
  std::vector<std::string> scene_words() const;
  /// The given options of the camera's lens.
  std::vector<std::string> lens_words() const;
  /// Adds a file that this run depends on, for --depfile (each once, in order). Throws InputError if an output would
  /// replace the file, unless it is `replaceable`.
  void depends_on(const std::string& file, InputRole role = InputRole::file);
  /// All warnings of this run, also those that were not shown.
  std::vector<std::string> warnings() const;

 private:
  void camera_options();
  void environment_options();
  void volume_options();

  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace tempolux::tools
