#include "tools/stages/filter_frames.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <optional>
#include <utility>

#include "formats/error.h"
#include "lib/filter/filter_frame.h"
#include "lib/image/channel_groups.h"
#include "lib/image/exr_io.h"
#include "lib/image/frame_identity.h"

namespace tempolux::tools {
namespace {

/// The files of a frame.
struct Names {
  std::string frame, flow;  ///< flow "": the flow is in the frame's own channels, or there is none
};

/// A loaded frame, and the data that the filter needs from it.
struct LoadedFrame {
  Image image;
  std::unique_ptr<WindowLight> light;  ///< nullptr if the frame is filtered alone
  FlowFrame flow;
};

class FilterRun {
 public:
  /// sequence: true to filter each frame in turn, with its neighbours; false to filter a single frame.
  FilterRun(Tool& tool, const FilterFramesOptions& options, std::vector<Names> names, bool sequence)
      : tool_(tool),
        options_(options),
        names_(std::move(names)),
        sequence_(sequence),
        windowed_(sequence || names_.size() > 1) {}

  /// Filters frame `at` of the list with the frames `first` to `last`.
  void run(std::size_t first, std::size_t at, std::size_t last, const std::string& file, std::optional<int> number) {
    Output output(file);
    loaded_.erase(loaded_.begin(), loaded_.lower_bound(first));
    const std::string& name = names_[at].frame;
    LoadedFrame& middle = load(at, true);
    tool_.stats().phase("filter", true);
    Image image;
    naming(name, [&] {
      if (first == last) image = filter_alone(std::move(middle.image));
      else image = filter_window(first, at, last, middle);
      if (!options_.channels.empty()) keep_channels(options_.channels, image);
    });
    say_noise(image);
    write_filtered(tool_, output, image, number);
  }

 private:
  /// Adds the frame's noise to the statistics, which report the root mean square over all frames.
  void say_noise(const Image& image) {
    const std::string prefix = "tempolux:";
    if (!image.numbers.contains(prefix + "noise.codes")) return;
    for (const auto& [attribute, value] : image.numbers) {
      if (!attribute.starts_with(prefix + "noise.") ||
          !(attribute.ends_with(".codes") || attribute.ends_with(".linear")))
        continue;
      const std::string name = attribute.substr(prefix.size());
      noise_[name] += value * value;
    }
    ++filtered_;
    for (const auto& [name, squares] : noise_) tool_.stats().set(name, std::sqrt(squares / filtered_));
  }

  Image filter_window(std::size_t first, std::size_t at, std::size_t last, LoadedFrame& middle) {
    FrameFilter filter(*middle.light, middle.flow, at - first, last - at);
    const auto add = [&](std::size_t i) {
      const LoadedFrame& other = load(i, sequence_);
      tool_.stats().phase("filter", true);
      filter.add(*other.light, other.flow);
      if (!sequence_) loaded_.erase(i);  // only two frames stay in memory
    };
    for (std::size_t i = at; i > first; --i) add(i - 1);
    for (std::size_t i = at + 1; i <= last; ++i) add(i);
    return filter.finish(std::move(middle.image));
  }

  /// Runs body; errors get the file's name in front.
  template <class Body>
  static void naming(const std::string& file, const Body& body) {
    try {
      body();
    } catch (const InputError& error) { throw InputError(file + ": " + error.what()); }
  }

  /// to_filter: true if the frame itself is filtered, now or later. Otherwise only the channels that the filter needs
  /// for its neighbours are read, and the image is not kept.
  LoadedFrame& load(std::size_t index, bool to_filter) {
    const auto [found, is_new] = loaded_.try_emplace(index);
    LoadedFrame& loaded = found->second;
    if (!is_new) return loaded;
    const Names& names = names_[index];
    tool_.stats().phase("read");
    loaded.image = read(names.frame, true, to_filter);
    Image& image = loaded.image;
    if (!names.flow.empty())
      loaded.flow = FlowFrame(read(names.flow, false, true), image.width, image.height, names.flow);
    else if (image.find("forward.u") || image.find("backward.u"))
      loaded.flow = FlowFrame(image, image.width, image.height, names.frame);
    tool_.stats().phase("prepare", true);
    naming(names.frame, [&] { check_noise(image); });
    if (windowed_) naming(names.frame, [&] { loaded.light = std::make_unique<WindowLight>(image, false); });
    explain(names, loaded);
    if (!to_filter) image = {};
    return loaded;
  }

  /// colour: true if pixels may be NaN; the filter fills such pixels from their neighbours. all: true to read every
  /// channel, or those of --channels if the option is given; false to read only the channels that the filter needs.
  Image read(const std::string& file, bool colour, bool all) {
    const auto is_named = [&](const std::string& channel) {
      return std::any_of(options_.channels.begin(), options_.channels.end(),
                         [&](const std::string& group) { return is_in_group(channel, group); });
    };
    const auto wanted = [&](const std::string& channel) {
      if (all && (options_.channels.empty() || is_named(channel))) return true;
      return is_read_to_filter(channel);
    };
    Image image = load_exr(file, {.allow_nan = colour, .wanted = wanted, .our_names = true});
    tool_.depends_on(file);
    return image;
  }

  /// Gives each warning once per run, for the first file that it applies to.
  void explain(const Names& names, const LoadedFrame& loaded) {
    if (names_.size() > 1 && loaded.flow.empty())
      warn("motion",
           names.frame +
               ": no flow (forward.u, forward.v, backward.u, backward.v) and no --flow; filtered as if nothing moved");
    else if (!loaded.flow.empty() && !(loaded.flow.has_forward() && loaded.flow.has_backward()))
      warn("direction", (names.flow.empty() ? names.frame : names.flow) +
                            ": flow in one direction only; the other is taken for its opposite");
    if (!knows_noise(loaded.image))
      warn("noise", names.frame +
                        ": no noise, variance or albedo; noise cannot be distinguished from texture, so the light "
                        "stays as it is");
    if (!loaded.image.find("Z") && !loaded.image.find("id.object"))
      warn("surfaces", names.frame + ": neither Z nor id.object; surfaces cannot be distinguished");
    if (!identity_in(loaded.image).known())
      warn("identity", names.frame + ": does not say which scene it shows; taken as it is");
  }
  void warn(const std::string& about, const std::string& message) {
    if (!std::exchange(warned_[about], true)) tool_.warn(message);
  }

  Tool& tool_;
  const FilterFramesOptions& options_;
  std::vector<Names> names_;
  bool sequence_, windowed_;
  std::map<std::size_t, LoadedFrame> loaded_;  ///< frames of the current window
  std::map<std::string, bool> warned_;
  std::map<std::string, double> noise_;  ///< by name: sum of squares
  int filtered_ = 0;                     ///< frames
};

void filter_files(Tool& tool, const FilterFramesOptions& options) {
  const std::size_t count = options.frames.size();
  if (!options.flow.empty() && options.flow.size() != count)
    throw InputError("--flow: " + std::to_string(options.flow.size()) + " files for " + std::to_string(count) +
                     " frames; name one for each, in the same order");
  if (options.position < 0 || std::size_t(options.position) > count)
    throw InputError("--position: there are " + std::to_string(count) + " frames; the first is 1");
  std::vector<Names> names;
  for (std::size_t i = 0; i < count; ++i)
    names.push_back({options.frames[i], options.flow.empty() ? "" : options.flow[i]});
  const std::size_t at = options.position > 0 ? std::size_t(options.position) - 1 : (count - 1) / 2;
  FilterRun(tool, options, std::move(names), false).run(0, at, count - 1, options.output, std::nullopt);
}

void filter_range(Tool& tool, const FilterFramesOptions& options) {
  if (options.frames.size() != 1 || !has_frame_pattern(options.frames[0]) || options.flow.size() > 1)
    throw InputError("--frames: name the frames, and their flow, by one pattern each, for example f.####.exr");
  if (!has_frame_pattern(options.output))
    throw InputError("--output: several frames need a pattern, for example f.####.exr");
  if (options.position != 0) throw InputError("--position: is for frames named one by one; leave it out, or --frames");
  std::vector<int> numbers = parse_frames(options.range);
  std::sort(numbers.begin(), numbers.end());
  std::vector<Names> names;
  for (const int number : numbers)
    names.push_back(
        {frame_name(options.frames[0], number), options.flow.empty() ? "" : frame_name(options.flow[0], number)});
  FilterRun run(tool, options, std::move(names), true);
  constexpr std::size_t kReach = 2;  // frames before and after the filtered one
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    // Flow leads to the next frame, so the window ends where a frame number is missing.
    std::size_t first = i, last = i;
    while (first > 0 && i - first < kReach && numbers[first - 1] == numbers[first] - 1) --first;
    while (last + 1 < numbers.size() && last - i < kReach && numbers[last + 1] == numbers[last] + 1) ++last;
    run.run(first, i, last, frame_name(options.output, numbers[i]), numbers[i]);
    tool.progress(double(i + 1) / double(numbers.size()));
  }
}

}  // namespace

void write_filtered(Tool& tool, Output& output, Image& image, std::optional<int> number) {
  image.text["tempolux:history"] += tool.history_line(number);
  tool.stats().phase("write");
  save_exr(output.temporary_path(), image);
  output.commit();
  tool.stats().end_phase();
  tool.stats().count("frames", 1);
  tool.stats().count("pixels", double(image.pixel_count()));
}

void filter_frames(Tool& tool, const FilterFramesOptions& options) {
  if (options.range.empty()) filter_files(tool, options);
  else filter_range(tool, options);
}

}  // namespace tempolux::tools
