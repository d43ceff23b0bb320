// tools/aqm-compare.cpp -- measures the error of a frame or a sequence, and predicts whether a viewer sees it.
//
//     aqm-compare frame.exr --reference-halves ref_a.exr ref_b.exr --json - | jq .total.rmse
//     aqm-compare out.####.exr ref.####.exr --frames 0-47 --layer indirect --difference diff.####.png
//     aqm-compare a.exr b.exr --flow flow.exr --except why.exr -o seen.png --fail-above 5%
//
// Error figures: lib/aqm/frame_error.h. Vision model: lib/aqm/visible_difference.h. JSON:
// formats/comparison/comparison.md.
#include <CLI/CLI.hpp>
#include <cmath>
#include <cstdio>
#include <optional>
#include <string>
#include <vector>

#include "formats/error.h"
#include "lib/aqm/difference.h"
#include "lib/image/exr_io.h"
#include "lib/report/comparison.h"
#include "tools/common/option_words.h"
#include "tools/common/percent_option.h"
#include "tools/common/tool_main.h"
#include "tools/stages/compare_inputs.h"
#include "tools/stages/vision_options.h"

using namespace tempolux;

namespace {

struct Options {
  std::string test, reference, layer, mask, except, smooth, json, difference, metric = "error";
  tools::VisionWords vision;
  std::vector<std::string> halves;
  bool own_halves = false, either = false, allow_stale = false;
  double fail_above = -1;
  bool fails_by_aqm = false;  ///< true: fail_above is a share of pixels; false: an RMSE

  bool needs_vision() const { return either || metric == "aqm" || fails_by_aqm || vision.used(); }
  std::string layer_or_rgb() const { return layer == "RGB" ? "" : layer; }
  std::vector<std::string> references() const { return halves.empty() ? std::vector{reference} : halves; }
};

void declare(tools::Tool& tool, Options& o) {
  CLI::App& app = tool.app();
  app.add_option("test", o.test, "frame to judge, EXR, or a pattern such as f.####.exr")->required();
  app.add_option("reference", o.reference, "its reference, unless --reference-halves is given");
  app.add_option("--reference-halves", o.halves, "two independent halves of the reference: no noise floor")
      ->expected(2)
      ->type_name("FILE");
  app.add_flag("--halves", o.own_halves, "the two frames are halves of one image: report its noise");
  app.add_option("--layer", o.layer, "layer or channel, such as indirect, N, Z; RGB without")->type_name("NAME");
  app.add_option("--mask", o.mask, "EXR; pixels where all its channels are 0 do not count")->type_name("FILE");
  app.add_option("--except", o.except,
                 "EXR, such as a mask of ibr-warp; pixels where one of its channels is not 0 do not count")
      ->type_name("FILE");
  app.add_option("--relative-to", o.smooth,
                 "EXR; replaces the reference in relMSE's denominator, where the reference's noise would matter")
      ->type_name("FILE");
  app.add_option(
         "--metric", o.metric,
         "error: RMSE, relMSE, bias, PSNR, flicker; aqm: also the share of pixels in which a viewer sees a difference")
      ->type_name("{error,aqm}")
      ->capture_default_str();
  tools::declare_vision(tool, o.vision);
  app.add_flag("--either", o.either,
               "the two frames have equal, independent errors, such as one frame warped from two keys: AQM judges the "
               "error of one of them, their difference / sqrt 2");
  tool.output_option(o.json, "write all figures as JSON; -: standard output", "--json");
  tool.output_option(o.difference, "write x - r: EXR, or PNG (grey 0, red above, blue below)", "--difference");
  app.add_option("--fail-above", o.fail_above, "exit 1 if the RMSE is above this; 5%: if AQM is")
      ->type_name("VALUE")
      ->check(tools::number_between(0))
      ->transform(tools::percent([&o] { o.fails_by_aqm = true; }));
  tool.leave_out_of_history(app.add_flag("--allow-stale", o.allow_stale, "compare frames of different scene states"));
  tool.common_options(tools::uses_frames);
}

void check(const tools::Tool& tool, const Options& o, bool frames_given) {
  if (o.metric != "error" && o.metric != "aqm")
    throw InputError("--metric " + o.metric + ": unknown; there are: error, aqm");
  tools::check_vision(o.vision, frames_given && tool.common().frames.size() > 1);
  if (o.reference.empty() == o.halves.empty())
    throw InputError("give the reference either as second file or as --reference-halves A B");
  if (o.own_halves && !o.halves.empty()) throw InputError("--halves: judges two files, without --reference-halves");
  if (!o.halves.empty() && (o.halves[0] == o.halves[1] || o.test == o.halves[0] || o.test == o.halves[1]))
    throw InputError("--reference-halves: the same file twice; the halves must be independent of each other and of x");
  if (frames_given && tool.common().frames.size() > 1 && !tools::has_frame_pattern(o.test))
    throw InputError(o.test + ": --frames names several frames; give a pattern such as f.####.exr");
  if (frames_given && tool.common().frames.size() > 1 && !o.difference.empty() &&
      !tools::has_frame_pattern(o.difference))
    throw InputError("--difference " + o.difference + ": give a pattern such as d.####.png for several frames");
  if (!frames_given && tools::has_frame_pattern(o.test))
    throw InputError(o.test + ": a pattern of frames; say which with --frames, such as 0-47");
  if (!o.difference.empty() && !o.difference.ends_with(".exr") && !o.difference.ends_with(".png"))
    throw InputError("--difference " + o.difference + ": the name must end in .exr or .png");
}

/// Writes the difference as EXR or PNG. If `scale` is 0 the first frame sets it for all frames.
void write_difference(tools::Tool& tool, const Compared& pair, std::optional<int> frame, double& scale,
                      tools::Output output) {
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

Comparison description(const tools::Tool& tool, const Options& o) {
  Comparison comparison;
  comparison.command = tool.history_line();
  comparison.command.pop_back();  // LF
  comparison.test = o.test;
  comparison.references = o.references();
  comparison.relative_to = o.smooth;
  comparison.flow = o.vision.flow;
  comparison.layer = o.layer_or_rgb();
  comparison.mode = !o.halves.empty() ? ComparisonMode::reference_halves
                    : o.own_halves    ? ComparisonMode::own_halves
                                      : ComparisonMode::one_reference;
  return comparison;
}

/// The output files of each frame.
class FrameOutputs {
 public:
  /// Creates the outputs of the first frame, so that an unwritable place is reported before the work.
  FrameOutputs(tools::Tool& tool, const Options& o, std::optional<int> first) : tool_(tool), o_(o) { open(first); }
  /// Creates the outputs of a later frame.
  void open(std::optional<int> frame) {
    difference_ = output(o_.difference, frame);
    map_ = output(o_.vision.map, frame);
  }
  void write(const Compared& pair, std::optional<int> frame) {
    if (difference_) write_difference(tool_, pair, frame, scale, std::move(*difference_));
  }
  void write(const JudgedFrame& judged, const tools::LoadedFrame& loaded, const VisionOptions& viewing,
             std::optional<int> frame) {
    if (map_) tools::write_map(tool_, judged, loaded, viewing, frame, std::move(*map_));
  }
  double scale = 0;  ///< of the PNG of differences, set by the first frame

 private:
  std::optional<tools::Output> output(const std::string& name, std::optional<int> frame) {
    if (name.empty()) return std::nullopt;
    return tools::Output(frame ? tools::frame_name(name, *frame) : name);
  }
  tools::Tool& tool_;
  const Options& o_;
  std::optional<tools::Output> difference_, map_;
};

/// Reads, compares and writes all frames.
Comparison compare_frames(tools::Tool& tool, const Options& o, const std::vector<std::optional<int>>& frames,
                          FrameOutputs& outputs) {
  ComparisonBuilder builder(description(tool, o));
  tools::IdentityGuard identities(tool, o.allow_stale);
  const tools::ComparedFiles names{o.test, o.references(), o.mask, o.layer_or_rgb(), o.smooth, o.except, o.vision.flow};
  std::optional<VisionOptions> viewing;
  for (std::size_t i = 0; i < frames.size(); ++i) {
    tool.stats().phase("load");
    const tools::LoadedFrame loaded(tool, names, frames[i]);
    identities.check(loaded.inputs());
    if (i) outputs.open(frames[i]);
    tool.stats().phase("compare");
    const Compared pair = compare_layers(loaded.inputs());
    builder.add(pair, frames[i].value_or(loaded.frame_number()), loaded.inputs().test.name);
    builder.add(object_names_in(*loaded.inputs().test.image));
    if (o.needs_vision()) {
      tool.stats().phase("vision");
      if (!viewing) viewing = tools::vision_options(o.vision, loaded), viewing->of_either = o.either;
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

int compare(tools::Tool& tool, const Options& o, bool frames_given) {
  check(tool, o, frames_given);
  std::vector<std::optional<int>> frames{std::nullopt};
  if (frames_given) frames.assign(tool.common().frames.begin(), tool.common().frames.end());
  std::optional<tools::Output> json;
  if (!o.json.empty()) json.emplace(o.json, tools::Output::Kind::text);
  FrameOutputs outputs(tool, o, frames.front());
  const Comparison result = compare_frames(tool, o, frames, outputs);

  const std::string text = comparison_json(result);
  if (json) json->write(text.data(), text.size()), json->commit();
  tool.stats().count("frames", double(frames.size()));
  tool.stats().count("pixels", double(result.total.pixels));
  tool.stats().set("rmse", result.total.squared_error.root());
  if (result.quality) tool.stats().set("aqm", result.quality->all.share());
  std::string table = comparison_text(result);
  char line[80];
  std::snprintf(line, sizeof line, ": red +%g, blue -%g\n", outputs.scale, outputs.scale);
  if (o.difference.ends_with(".png")) table += o.difference + line;
  if (!tool.common().quiet) std::fputs(table.c_str(), json && json->is_stdout() ? stderr : stdout);
  const double judged = o.fails_by_aqm ? result.quality->all.share() : result.total.squared_error.root();
  return o.fail_above >= 0 && judged > o.fail_above ? tools::exit_differs : tools::exit_ok;
}

}  // namespace

int main(int argc, char** argv) {
  tools::Tool tool("aqm-compare", "Measure the error of a frame or a sequence, and predict whether a viewer sees it.",
                   argc, argv);
  Options options;
  declare(tool, options);
  return tool.run([&] { return compare(tool, options, tool.app().get_option("--frames")->count() > 0); });
}
