// tools/aqm-compare.cpp -- measures the error of a frame or a sequence, and predicts whether a viewer sees it.
//
//     aqm-compare frame.exr --reference-halves ref_a.exr ref_b.exr --json - | jq .total.rmse
//     aqm-compare out.####.exr ref.####.exr --frames 0-47 --layer indirect --difference diff.####.png
//     aqm-compare a.exr b.exr --flow flow.exr --except why.exr -o seen.png --fail-above 5%
//
// Error figures: lib/aqm/frame_error.h. Vision model: lib/aqm/visible_difference.h. JSON:
// formats/comparison/comparison.md.
#include "tools/common/cli.h"
#include "tools/common/option_words.h"
#include "tools/common/percent_option.h"
#include "tools/stages/compare_frames.h"

using namespace tempolux;

namespace {

void declare(tools::Tool& tool, tools::CompareOptions& o) {
  CLI::App& app = tool.app();
  tool.file_option("test", o.test, "frame to judge, EXR, or a pattern such as f.####.exr")->required();
  tool.file_option("reference", o.reference, "its reference, unless --reference-halves is given");
  tool.file_option("--reference-halves", o.reference_halves, "two independent halves of the reference: no noise floor")
      ->expected(2);
  app.add_flag("--halves", o.halves, "the two frames are halves of one image: report its noise");
  app.add_option("--layer", o.layer, "layer or channel, such as indirect, N, Z; RGB without")->type_name("NAME");
  tool.file_option("--mask", o.mask, "EXR; pixels where all its channels are 0 do not count");
  tool.file_option("--except", o.except,
                   "EXR, such as a mask of ibr-warp; pixels where one of its channels is not 0 do not count");
  tool.file_option("--relative-to", o.relative_to,
                   "EXR; replaces the reference in relMSE's denominator, where the reference's noise would matter");
  tool.choice_option(
      "--metric", o.metric, {"error", "aqm"},
      "error: RMSE, relMSE, bias, PSNR, flicker; aqm: also the share of pixels in which a viewer sees a difference");
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

}  // namespace

int main(int argc, char** argv) {
  tools::Tool tool("aqm-compare", "Measure the error of a frame or a sequence, and predict whether a viewer sees it.",
                   argc, argv);
  tools::CompareOptions options;
  declare(tool, options);
  return tool.run([&] { return tools::compare(tool, options, tool.app().get_option("--frames")->count() > 0); });
}
