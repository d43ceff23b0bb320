// tools/common/options.cpp -- the options that all tools share, and the layout of --help and --version.
#include <link.h>
#include <stdlib.h>

#include <algorithm>
#include <charconv>
#include <filesystem>
#include <memory>
#include <sstream>
#include <string>

#include "formats/error.h"
#include "tools/common/option_words.h"
#include "tools/common/tool_state.h"

namespace tempolux::tools {
namespace {

/// Adds an option whose text `parse` converts to a value; errors name the option.
CLI::Option* parsed_option(CLI::App& app, const std::string& names, const std::string& help,
                           const std::string& shown_default, const std::function<void(const std::string&)>& parse) {
  const std::string first = names.substr(0, names.find(','));
  const std::function<void(const std::string&)> named = [first, parse](const std::string& text) {
    try {
      parse(text);
    } catch (const InputError& error) { throw InputError(first + ": " + error.what()); }
  };
  CLI::Option* option = app.add_option_function<std::string>(names, named, help);
  if (!shown_default.empty()) option->default_str(shown_default);
  return option;
}

std::string format_bytes(std::uint64_t bytes) {
  const char* const suffixes[] = {"", "KiB", "MiB", "GiB", "TiB"};
  std::size_t power = 0;
  while (bytes != 0 && bytes % 1024 == 0 && power < 4) bytes /= 1024, ++power;
  return std::to_string(bytes) + suffixes[power];
}

void seed_options(Tool& tool, Common& common) {
  tool.app()
      .add_option("--seed", common.seed, "seed of the random numbers, 0 to 2^64-1")
      ->type_name("N")
      ->capture_default_str()
      ->check([](const std::string& text) -> std::string {
        std::uint64_t seed = 0;
        const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), seed);
        const bool whole = error == std::errc{} && end == text.data() + text.size();
        return whole ? "" : "'" + text + "' is not a whole number from 0 to 2^64-1";
      });
  tool.choice_option("--seed-mode", common.seed_mode, {"fixed", "frame"},
                     "fixed: one seed for all frames; frame: another for each")
      ->type_name("MODE");
}

/// Options of the scene's time and lights.
void scene_options(Tool& tool, Common& common) {
  tool.number_option("--fps", common.fps, 1e-3, 1e6, "frames per second: frame f is at f / fps seconds")
      ->type_name("RATE");
  tool.number_option("--segment", common.segment_length, 1, 1e6,
                     "frames in a segment; an object is static if it does not change within a segment")
      ->type_name("FRAMES");
  tool.app()
      .add_option("--animation", common.animation,
                  "play only this animation of the scene; all play together if not given")
      ->type_name("NAME");
  tool.choice_option("--light-units", common.light_units, {"raw", "spec"},
                     "raw: lights unchanged; spec: point, spot and sun lights divided by 683 lm/W")
      ->type_name("UNITS");
}

class HelpFormatter : public CLI::Formatter {
 public:
  std::string make_usage(const CLI::App* app, std::string name) const override {
    return "Usage: " + name + " [OPTIONS]" + positional_words(*app) + "\n";
  }
  std::string make_option(const CLI::Option* option, bool is_positional) const override {
    constexpr std::size_t kIndent = 30, kWidth = 100;
    std::string left = "  " + (is_positional ? option->get_single_name() : option->get_name(false, true));
    if (!is_positional && option->get_expected_max() > 0) left += " " + value_name(*option);
    std::string right = option->get_description();
    if (const std::string limits = limits_of(*option); !limits.empty()) right += " (" + limits + ")";
    if (!option->get_default_str().empty()) right += " [" + option->get_default_str() + "]";
    if (option->get_required()) right += " (required)";
    if (!option->get_envname().empty()) right += " (environment: " + option->get_envname() + ")";

    std::string text = left;
    std::size_t column = left.size();
    if (column >= kIndent) text += '\n', column = 0;
    std::istringstream words(right);
    bool first = true;
    for (std::string word; words >> word;) {
      if (!first && column + 1 + word.size() > kWidth) text += '\n', column = 0, first = true;
      if (first) text.append(kIndent - column, ' '), column = kIndent;
      if (!first) text += ' ', ++column;
      text += word;
      column += word.size();
      first = false;
    }
    return text + '\n';
  }
};

/// Collects the file of each loaded shared object, except those of the C and C++ runtime.
int add_library(dl_phdr_info* info, std::size_t, void* names) {
  if (!info->dlpi_name || info->dlpi_name[0] != '/') return 0;
  std::error_code error;
  const std::string file = std::filesystem::canonical(info->dlpi_name, error).filename().string();
  for (const char* usual : {"libc.", "libc-", "libm.", "libm-", "libstdc++", "libgcc_s", "ld-"})
    if (file.starts_with(usual)) return 0;
  if (!file.empty()) *static_cast<std::string*>(names) += " " + file;
  return 0;
}

}  // namespace

std::shared_ptr<CLI::FormatterBase> help_formatter() { return std::make_shared<HelpFormatter>(); }

std::string version_text(const std::string& tool) {
  std::string libraries;
  dl_iterate_phdr(add_library, &libraries);
  return tool + " (tempolux) " TEMPOLUX_VERSION "\ncompiler: " __VERSION__ "\nlibraries: CLI11-" CLI11_VERSION +
         libraries + '\n';
}

void Tool::environment_options() {
  Common& common = state_->common;
  CLI::Option* light = state_->app
                           .add_option("--environment", common.environment,
                                       "light around the scene: a latitude-longitude map, .hdr or .exr, or R,G,B, one "
                                       "radiance from all directions, W/m^2/sr. The middle of a map is +Z, its top +Y; "
                                       "maps made for Blender's axes need --environment-rotation 90")
                           ->type_name("LIGHT");
  number_option("--environment-strength", common.environment_strength, 0, 1e30,
                "radiance of a map's pixel of value 1, W/m^2/sr")
      ->type_name("X")
      ->needs(light);
  number_option("--environment-rotation", common.environment_rotation_deg, -1e6, 1e6,
                "turns the map about +Y, from +Z towards +X, degrees")
      ->type_name("DEG")
      ->needs(light);
}

void Tool::volume_options() {
  CLI::App& app = state_->app;
  VolumeOptions& volume = state_->common.volume;
  file_option("--volume", volume.files,
              "OpenVDB file, or a pattern such as smoke.####.vdb, of a medium in metres of world space; replaces "
              "the media that the scene names; none: no media; repeat it for several media. smoke.vdb:soot reads "
              "the grid soot, smoke.vdb:soot:1 the second grid of that name, else density or the only density grid")
      ->allow_extra_args(false);
  parsed_option(app, "--volume-frames", "frames that have a file; other frames use the nearest one [all]", "",
                [&volume](const std::string& text) {
                  const std::vector<int> frames = parse_frames(text);
                  const auto [least, most] = std::ranges::minmax(frames);
                  volume.frames = std::pair{least, most};
                })
      ->type_name("FRAMES");
  app.add_option("--volume-up", volume.up, "axis of the files that points up: y, or z as Blender writes them [y]")
      ->type_name("AXIS")
      ->check(CLI::IsMember({"y", "z"}));
  app.add_option("--sigma-t", volume.sigma_t, "extinction of density 1, 1/m [1]")
      ->type_name("X")
      ->allow_extra_args(false)
      ->check(number_between(0, 1e30));
  app.add_option_function<std::vector<std::string>>(
         "--albedo",
         [&volume](const std::vector<std::string>& texts) {
           for (const std::string& text : texts) volume.albedo.push_back(parse_color(text));
         },
         "share of the extinction that is scattered, 0 to 1: R,G,B or one number [1]")
      ->type_name("R,G,B")
      ->allow_extra_args(false);
  app.add_option("--phase-g", volume.phase_g, "mean cosine of scattering by Henyey and Greenstein: forward above 0 [0]")
      ->type_name("X")
      ->allow_extra_args(false)
      ->check(number_between(-0.9999, 0.9999));
}

void Tool::camera_options() {
  CLI::App& app = state_->app;
  Common& common = state_->common;
  app.add_option("--camera", common.camera,
                 "name of the camera; auto: the scene's first camera, or a new one that shows the whole content")
      ->type_name("NAME")
      ->capture_default_str();
  const auto lens = [&](CLI::Option* option) {
    state_->of_lens.insert(option);
    return option;
  };
  CLI::Option* const f_stop =
      lens(app.add_option("--f-stop", common.lens.f_stop,
                          "depth of field: focal length over the diameter of the lens' opening, "
                          "such as 2.8; 0: none, everything is sharp [as the scene says]"))
          ->type_name("N")
          ->check(number_between(0, 1e6));
  lens(app.add_option("--lens-radius", common.lens.radius_m,
                      "radius of the lens' opening in place of --f-stop, m; 0: none [as the scene says]"))
      ->type_name("M")
      ->check(number_between(0, 1e3))
      ->excludes(f_stop);
  lens(app.add_option(
           "--focus", common.lens.focus,
           "what is sharp: a distance along the view axis, m, inf, or the name of a node [as the scene says]"))
      ->type_name("WHAT");
  lens(app.add_option("--sensor-width", common.lens.sensor_width_mm,
                      "sensor along the picture's longer side, mm, which with the angle of view gives the focal length "
                      "[as the scene says, or 36]"))
      ->type_name("MM")
      ->check(number_between(0.1, 1e4));
  const auto shutter = [&](CLI::Option* option) {
    state_->of_scene.insert(option);
    return option;
  };
  shutter(
      app.add_option("--shutter", common.lens.shutter_deg,
                     "motion blur: time that the shutter is open, degrees of the frame, such as 180 for half of it; 0: "
                     "none [as the scene says]"))
      ->type_name("DEG")
      ->check(number_between(0, 36000));
  shutter(app.add_option("--shutter-open", common.lens.shutter_open,
                         "where the frame's time lies in it: centre: in the middle, begin: where the shutter opens [as "
                         "the scene says, or centre]"))
      ->type_name("WHEN")
      ->check(CLI::IsMember({"centre", "begin"}));
}

void Tool::common_options(unsigned flags) {
  CLI::App& app = state_->app;
  Common& common = state_->common;
  if (flags & uses_frames)
    parsed_option(app, "--frames,--frame", "frame, or frames such as 0-47, 0-47x2 or 1,5,9", "0",
                  [&common](const std::string& text) { common.frames = parse_frames(text); })
        ->type_name("FRAMES");
  if (flags & uses_camera) camera_options();
  if (flags & uses_seed) seed_options(*this, common);
  if (flags & uses_scene) {
    const auto before = std::ptrdiff_t(app.get_options().size());
    scene_options(*this, common);
    environment_options();
    volume_options();
    const std::vector<CLI::Option*> options = app.get_options();
    state_->of_scene.insert(options.begin() + before, options.end());
    if (flags & uses_majorants)
      file_option("--majorants", common.volume.majorants,
                  "majorants file of scene-plan, state/FRAME-KEY.majorants: bounds of the extinction for a whole "
                  "segment; needed for maps that are updated");
    state_->of_scene.insert(leave_out_of_history(
        app.add_flag("--allow-stale", common.allow_stale, "use inputs made for another state of the scene")));
  }
  leave_out_of_history(app.add_option("--threads", common.threads, "threads; 0: all processors this process may use"))
      ->type_name("N")
      ->capture_default_str()
      ->envname("TEMPOLUX_THREADS")
      ->check(number_between(0, 4096));
  leave_out_of_history(
      bytes_option("--max-memory", common.max_memory_bytes,
                   "limit of memory, such as 300MiB; it counts reserved addresses, some 100 MiB more than a tool uses; "
                   "0: none"))
      ->envname("TEMPOLUX_MAX_MEMORY");
  output_option(common.stats_file, "write seconds, counts and memory as JSON; -: standard output", "--stats");
  output_option(common.dep_file, "write a make rule: outputs depend on inputs", "--depfile");
  leave_out_of_history(app.add_flag("-q,--quiet", common.quiet, "print errors only"));
  leave_out_of_history(app.add_flag("-v,--verbose", common.verbose, "report each phase and its time"));
}

CLI::Option* Tool::output_option(std::string& path, const std::string& help, const std::string& names) {
  return leave_out_of_history(file_option(names, path, help));
}

CLI::Option* Tool::file_option(const std::string& names, std::string& file, const std::string& help) {
  CLI::Option* option = state_->app.add_option(names, file, help)->type_name("FILE");
  state_->files.insert(option);
  return option;
}

CLI::Option* Tool::file_option(const std::string& names, std::vector<std::string>& files, const std::string& help) {
  CLI::Option* option = state_->app.add_option(names, files, help)->type_name("FILE");
  state_->files.insert(option);
  return option;
}

CLI::Option* Tool::choice_option(const std::string& names, std::string& word, const std::vector<std::string>& words,
                                 const std::string& help) {
  return state_->app.add_option(names, word, help)->capture_default_str()->check(CLI::IsMember(words));
}

CLI::Option* Tool::list_option(const std::string& names, std::vector<std::string>& words, const std::string& help) {
  std::string preset;
  for (const std::string& word : words) preset += (preset.empty() ? "" : ",") + word;
  return state_->app.add_option(names, words, help)->delimiter(',')->type_name("NAMES")->default_str(preset);
}

template <class Number>
CLI::Option* Tool::number_option(const std::string& names, Number& number, double least, double most,
                                 const std::string& help) {
  return state_->app.add_option(names, number, help)->capture_default_str()->check(number_between(least, most));
}
template CLI::Option* Tool::number_option(const std::string&, int&, double, double, const std::string&);
template CLI::Option* Tool::number_option(const std::string&, float&, double, double, const std::string&);
template CLI::Option* Tool::number_option(const std::string&, double&, double, double, const std::string&);

CLI::Option* Tool::auto_option(const std::string& names, std::optional<double>& number, double least, double most,
                               const std::string& help) {
  return parsed_option(state_->app, names, help, "auto", [&number, least, most](const std::string& text) {
    double value = 0;
    const bool valid = CLI::detail::lexical_cast(text, value) && value > least && value < most;
    if (!valid && text != "auto") {
      std::ostringstream limits;
      limits << "above " << least;
      if (most < kNoLimit) limits << " and below " << most;
      throw InputError("'" + text + "' is neither auto nor a number " + limits.str());
    }
    number = valid ? std::optional(value) : std::nullopt;
  });
}

CLI::Option* Tool::count_option(const std::string& names, std::uint64_t& count, const std::string& help) {
  return parsed_option(state_->app, names, help, format_count(count),
                       [&count](const std::string& text) { count = parse_count(text); })
      ->type_name("N");
}

CLI::Option* Tool::bytes_option(const std::string& names, std::uint64_t& bytes, const std::string& help) {
  return parsed_option(state_->app, names, help, format_bytes(bytes),
                       [&bytes](const std::string& text) { bytes = parse_bytes(text); })
      ->type_name("SIZE");
}

CLI::Option* Tool::size_option(const std::string& names, int& width, int& height, const std::string& help) {
  return parsed_option(state_->app, names, help, std::to_string(width) + "x" + std::to_string(height),
                       [&width, &height](const std::string& text) { parse_size(text, width, height); })
      ->type_name("WxH");
}

void Tool::check_patterns(const std::vector<std::string>& names) const {
  for (const std::string& name : names)
    if (state_->common.frames.size() > 1 && !name.empty() && !has_frame_pattern(name))
      throw InputError("'" + name + "': several frames need a pattern, for example f.####.exr");
}

void Tool::check_frame_output(const std::string& name) const {
  check_patterns({name});
  if (name == "-") throw InputError("--output: a frame is a file, readers of OpenEXR must seek; name one");
}

CLI::Option* Tool::leave_out_of_history(CLI::Option* option) {
  state_->left_out_of_history.insert(option);
  return option;
}

}  // namespace tempolux::tools
