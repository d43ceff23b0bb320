// tools/scene-plan.cpp -- decides which stages a range of frames needs, and from which files each picture is made.
//
//     scene-plan room.glb --frames 0-47 -o out
//
// Writes out/plan.json, out/plan.mk and out/state/*. If scene, options and programs have not changed, it only finds
// that out and writes nothing. Format: formats/plan/plan.md.
#include <algorithm>
#include <filesystem>
#include <iostream>
#include <string>

#include "formats/error.h"
#include "formats/hash.h"
#include "lib/core/formatted.h"
#include "lib/core/parallel.h"
#include "lib/plan/estimate.h"
#include "tools/common/cli.h"
#include "tools/common/option_words.h"
#include "tools/common/percent_option.h"
#include "tools/stages/plan_range.h"
#include "tools/stages/samples.h"

using namespace tempolux;

namespace {

/// Options that choose the methods.
void add_methods(tools::Tool& tool, tools::PlanOptions& options) {
  Wish& wish = options.wish;
  tool.choice_option("--quality", options.quality, {"draft", "final"}, "draft: fewer samples and more noise; final");
  tool.choice_option(
      "--method", options.method, {"auto", "frames", "still", "walkthrough", "preview"},
      "frames: every frame is rendered; still: while the camera stands, only pixels that change are sampled; auto: "
      "still where it pays, else frames; walkthrough: key frames are rendered, frames between them are warped; "
      "preview: "
      "fast, with light textures from the photons of many frames");
  tool.choice_option(
      "--filter", options.filter, {"auto", "none", "1", "3", "5", "7", "9"},
      "number of frames in the filter's window, 1: each frame alone; a frame is filtered where the halves of its "
      "samples show that it helps; none: no filter; auto: 1, or none with --words pixels:...");
  tool.choice_option(
      "--indirect", wish.indirect, {"auto", "records", "gather", "paths"},
      "how indirect light is found: records, gather (in the pixel, by points), paths; auto: the cheapest by a pilot");
  tool.choice_option(
      "--moving", wish.moving, {"auto", "anew", "light", "records", "time"},
      "what a frame takes from the static light of its segment: anew: nothing; light: photons and points; records: "
      "photons, points and records; time: photons and points, and records keep their incoming light from frame to "
      "frame; auto: the cheapest by a pilot");
  tool.choice_option("--split", wish.split, {"auto", "on", "off"},
                     "on: bright points are sampled explicitly; auto: where a pilot finds that it pays");
}

/// The shares of pixels in which a viewer may see errors, as "draft 20%, final 5%".
std::string seen_of_presets() {
  Wish draft, final;
  draft.quality = Quality::draft;
  final.quality = Quality::final;
  return formatted("draft %g%%, final %g%%", 100 * draft.seen(), 100 * final.seen());
}

/// Options that replace figures of the preset.
void add_figures(tools::Tool& tool, tools::PlanOptions& options) {
  CLI::App& app = tool.app();
  Wish& wish = options.wish;
  const auto text = [&](const char* name, std::string& value, const char* type, const char* help) {
    app.add_option(name, value, help)->type_name(type);
  };
  tool.size_option("--size", wish.width, wish.height, "size of the frames, pixels");
  app.add_option("--channels", wish.channels, "channels of the frames, as frame-render --channels; RGBA is needed")
      ->capture_default_str();
  tool.count_option("--photons", wish.photons,
                    "light paths of a photon map (preview: of a frame); up to 16 times as many where few of them "
                    "arrive; 0: the preset's");
  text("--measured", options.measured, "FILE",
       "preview: photons of each segment by what `make measure` has written into this file");
  app.add_option("--aqm", options.aqm,
                 "with --measured: share of the pixels in which a viewer may see errors; without: " + seen_of_presets())
      ->check(tools::number_between(0, 1))
      ->transform(tools::percent());
  tool.number_option("--pixel-error", wish.pixel_error, 0, 10, "as frame-render --pixel-error; 0: the preset's");
  app.add_option(
         "--words", options.words,
         "options of a stage instead of the preset's, such as 'pixels:--spp 4 --pixel-error 0'. Stages: points, "
         "records (irradcache-build), pixels (frame-render), smoke (volume-compose)")
      ->type_name("STAGE:OPTIONS")
      ->allow_extra_args(false);
  text("--update", wish.update, "SHARE",
       "with smoke: trace this share of each photon map anew, such as 10%, and keep the remainder");
  text("--refine", wish.refine, "SHARE",
       "with smoke: further paths for each map where light in the smoke is noisy, as a share of its paths, such as 5%");
  app.add_option("--strategy", wish.strategy, "groups of photons that --update traces, as photon-trace --strategy")
      ->capture_default_str();
  text("--shot", options.shot, "FIRST-LAST", tools::kShotHelp);
  tool.number_option("--key-distance", wish.key_distance, 2, 1000, "frames between the first keys of a walkthrough");
  app.add_option("--halve-above", wish.threshold,
                 "an interval between keys is halved if a viewer sees errors in more than this share of its pixels "
                 "(AQM); without: " +
                     seen_of_presets())
      ->check(tools::number_between(0, 1))
      ->transform(tools::percent());
  tool.auto_option("--exposure", wish.exposure, -200, 200,
                   "exposure of the previews: brightness times 2^STOPS; auto: what suits the first frame")
      ->type_name("STOPS");
  text("--report", options.report, "FRAMES", "frames to compare with path tracing; ends: the first and the last");
  tool.number_option("--reference-samples", wish.reference_samples, 2, 1 << 20, "samples per pixel of the reference");
}

/// Options that change neither the files of a shot nor their names. Each takes a value.
const std::string kNotOfShot[] = {"--frames", "--threads", "--stats"};

}  // namespace

int main(int argc, char** argv) {
  tools::Tool tool("scene-plan",
                   "Decide which stages a range of frames needs, and from which files each picture is made.", argc,
                   argv);
  tools::PlanOptions options;
  CLI::App& app = tool.app();
  app.add_option("scene", options.scene, "glTF scene, .gltf or .glb; without one --estimate prints");
  tool.output_option(options.folder, "folder for plan.json, plan.mk and state/, and of all files that they name")
      ->capture_default_str();
  add_methods(tool, options);
  add_figures(tool, options);
  // Options that change no file of a plan are left out of its history.
  tool.leave_out_of_history(tool.file_option(
      "--recipes", options.recipes, "files with the rules of make: if one of them changes, all files are made again"));
  tool.leave_out_of_history(
      app.add_option("--estimate", options.estimate,
                     "write two small plans into this folder instead of a plan; make runs them. Without a scene: print "
                     "the estimated cost, CPU seconds and bytes of each stage, from their statistics (make -f "
                     "Makefile.example estimate)")
          ->type_name("FOLDER"));
  tool.common_options(tools::uses_scene | tools::uses_camera | tools::uses_frames);
  // `shot`: the words without kNotOfShot.
  std::string arguments = std::filesystem::current_path().string(), shot;
  for (int i = 1; i < argc; ++i) {
    const std::string word(argv[i]), before(argv[i - 1]);
    arguments.append(word).push_back('\0');
    const bool left_out = std::ranges::any_of(kNotOfShot, [&](const std::string& option) {
      return word == option || before == option || word.starts_with(option + "=");
    });
    if (!left_out) shot.append(word).push_back('\0');
  }
  return tool.run([&] {
    if (options.scene.empty() && options.estimate.empty()) throw InputError("scene is required; see scene-plan --help");
    if (!options.scene.empty()) tools::plan_range(tool, options, hash_hex(arguments), hash_hex(shot));
    else std::cout << estimate_text(tools::estimate_from(options.estimate), usable_processor_count());
    return int(tools::exit_ok);
  });
}
