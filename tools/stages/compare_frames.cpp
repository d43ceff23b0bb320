#include "tools/stages/compare_frames.h"

#include <cstdio>
#include <optional>
#include <utility>

#include "formats/error.h"
#include "lib/aqm/difference.h"
#include "lib/core/formatted.h"
#include "lib/image/exr_io.h"
#include "lib/report/comparison.h"
#include "tools/stages/compare_inputs.h"

namespace tempolux::tools {
namespace {

void check(const Tool& tool, const CompareOptions& o, bool frames_given) {
  if (o.reference.empty() == o.reference_halves.empty())
    throw InputError("give the reference either as second file or as --reference-halves A B");
  if (o.halves && !o.reference_halves.empty())
    throw InputError("--halves: judges two files, without --reference-halves");
  if (!o.reference_halves.empty() && (o.reference_halves[0] == o.reference_halves[1] ||
                                      o.test == o.reference_halves[0] || o.test == o.reference_halves[1]))
    throw InputError("--reference-halves: the same file twice; the halves must be independent of each other and of x");
  tool.check_patterns({o.test, o.difference, o.vision.map});
  if (!frames_given && has_frame_pattern(o.test))
    throw InputError(o.test + ": a pattern of frames; say which with --frames, such as 0-47");
  for (const auto& [option, name] : {std::pair{"--difference ", o.difference}, {"--map ", o.vision.map}})
    if (!name.empty() && !name.ends_with(".exr") && !name.ends_with(".png"))
      throw InputError(option + name + ": the name must end in .exr or .png");
}

/// Writes the difference as EXR or PNG. If `scale` is 0 the first frame sets it for all frames.
void write_difference(Tool& tool, const Compared& pair, std::optional<int> frame, double& scale, Output output) {
  if (output.path().ends_with(".exr")) {
    Image image = difference_image(pair);
    image.text["tempolux:history"] = tool.history_line(frame);
    save_exr(output.temporary_path(), image);
  } else {
    if (scale == 0) scale = difference_scale(pair);
    save_png(output.temporary_path(), difference_picture(pair, scale));
  }
  output.commit();
}

Comparison description(const Tool& tool, const CompareOptions& o) {
  Comparison comparison;
  comparison.command = tool.history_line();
  comparison.command.pop_back();  // LF
  comparison.test = o.test;
  comparison.references = o.references();
  comparison.relative_to = o.relative_to;
  comparison.flow = o.vision.flow;
  comparison.layer = o.layer_or_rgb();
  comparison.mode = !o.reference_halves.empty() ? ComparisonMode::reference_halves
                    : o.halves                  ? ComparisonMode::own_halves
                                                : ComparisonMode::one_reference;
  return comparison;
}

/// The output files of each frame.
class FrameOutputs {
 public:
  /// Creates the outputs of the first frame, so that an unwritable place is reported before the work.
  FrameOutputs(Tool& tool, const CompareOptions& o, std::optional<int> first) : tool_(tool), o_(o) { open(first); }
  /// Creates the outputs of a later frame.
  void open(std::optional<int> frame) {
    difference_ = output(o_.difference, frame);
    map_ = output(o_.vision.map, frame);
  }
  void write(const Compared& pair, std::optional<int> frame) {
    if (difference_) write_difference(tool_, pair, frame, scale, std::move(*difference_));
  }
  void write(const JudgedFrame& judged, const LoadedFrame& loaded, const VisionOptions& viewing,
             std::optional<int> frame) {
    if (map_) write_map(judged, loaded, viewing, tool_.history_line(frame), std::move(*map_));
  }
  double scale = 0;  ///< of the PNG of differences, set by the first frame

 private:
  std::optional<Output> output(const std::string& name, std::optional<int> frame) {
    if (name.empty()) return std::nullopt;
    return Output(frame ? frame_name(name, *frame) : name);
  }
  Tool& tool_;
  const CompareOptions& o_;
  std::optional<Output> difference_, map_;
};

/// Reads, compares and writes all frames.
Comparison compare_frames(Tool& tool, const CompareOptions& o, const std::vector<std::optional<int>>& frames,
                          FrameOutputs& outputs) {
  ComparisonBuilder builder(description(tool, o));
  IdentityGuard identities(tool, o.allow_stale);
  const ComparedFiles names{o.test, o.references(), o.mask, o.layer_or_rgb(), o.relative_to, o.except, o.vision.flow};
  std::optional<VisionOptions> viewing;
  for (std::size_t i = 0; i < frames.size(); ++i) {
    tool.stats().phase("load");
    const LoadedFrame loaded(tool, names, frames[i]);
    identities.check(loaded.inputs());
    if (i) outputs.open(frames[i]);
    tool.stats().phase("compare");
    const Compared pair = compare_layers(loaded.inputs());
    builder.add(pair, frames[i].value_or(loaded.frame_number()), loaded.inputs().test.name);
    builder.add(object_names_in(*loaded.inputs().test.image));
    if (o.needs_vision()) {
      tool.stats().phase("vision");
      if (!viewing) viewing = vision_options(o.vision, loaded), viewing->of_either = o.either;
      const JudgedFrame judged = judge_frame(pair, loaded.flow(), *viewing, loaded.inputs().test.name);
      builder.add(judged.quality, *viewing);
      outputs.write(judged, loaded, *viewing, frames[i]);
    }
    tool.stats().phase("write");
    outputs.write(pair, frames[i]);
    tool.progress(double(i + 1) / double(frames.size()));
  }
  return builder.finish();
}

}  // namespace

int compare(Tool& tool, const CompareOptions& o, bool frames_given) {
  check(tool, o, frames_given);
  std::vector<std::optional<int>> frames{std::nullopt};
  if (frames_given) frames.assign(tool.common().frames.begin(), tool.common().frames.end());
  std::optional<Output> json;
  if (!o.json.empty()) json.emplace(o.json, Output::Kind::text);
  FrameOutputs outputs(tool, o, frames.front());
  const Comparison result = compare_frames(tool, o, frames, outputs);

  const std::string text = comparison_json(result);
  if (json) json->write(text.data(), text.size()), json->commit();
  tool.stats().count("frames", double(frames.size()));
  tool.stats().count("pixels", double(result.total.pixels));
  tool.stats().set("rmse", result.total.squared_error.root());
  if (result.quality) tool.stats().set("aqm", result.quality->all.share());
  std::string table = comparison_text(result);
  if (o.difference.ends_with(".png"))
    table += o.difference + formatted(": red +%g, blue -%g\n", outputs.scale, outputs.scale);
  if (!tool.common().quiet) std::fputs(table.c_str(), json && json->is_stdout() ? stderr : stdout);
  const double judged = o.fails_by_aqm ? result.quality->all.share() : result.total.squared_error.root();
  return o.fail_above >= 0 && judged > o.fail_above ? exit_differs : exit_ok;
}

}  // namespace tempolux::tools
