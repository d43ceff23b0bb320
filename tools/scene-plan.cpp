// tools/scene-plan.cpp -- say what a range of frames needs, as make variables and state files.
//
//     scene-plan room.glb --frames 0-47 -o plan
//
// Writes plan/plan.json, plan/plan.mk and plan/state/*. A file whose content would be the same is left
// untouched, except plan.mk, which make wants newer than the scene. Format: formats/plan/plan.md.
//
//     scene-plan room.glb --frames 0-47 --estimate --frame-options '--size 960x540'
//     scene-plan --tidy out
#include <CLI/CLI.hpp>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <iterator>
#include <optional>
#include <string>
#include <vector>

#include "formats/error.h"
#include "lib/core/parallel.h"
#include "lib/plan/plan_files.h"
#include "lib/render/choose_caustics.h"
#include "lib/render/choose_indirect.h"
#include "lib/render/choose_photons.h"
#include "lib/render/choose_moving.h"
#include "lib/render/choose_split.h"
#include "lib/render/learn_lights.h"
#include "lib/render/seen_spheres.h"
#include "tools/common/option_words.h"
#include "tools/common/pilot.h"
#include "tools/common/plan_views.h"
#include "tools/common/scene_input.h"
#include "tools/common/tidy.h"

using namespace tempolux;

namespace {

void make_folder(const std::string& folder) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error) throw ResourceError(folder + ": cannot create this folder: " + error.message());
}

/// Returns true if the file was new or different. There are thousands of them in a long range, all compared with what
/// they should hold whenever there is a plan: not synced one by one.
bool write_if_changed(const std::string& path, const std::string& content) {
  std::ifstream present(path, std::ios::binary);
  if (present && std::string(std::istreambuf_iterator<char>(present), {}) == content) return false;
  tools::Output output(path, false, tools::Output::Kind::text);
  output.write(content.data(), content.size());
  output.commit_unsynced();
  return true;
}

struct Options {
  std::string scene, folder = "plan", tidy_folder, indirect = "auto", moving = "auto", split = "auto";
  double tidy_hours = 24, pixel_error = 0.016;
  int rays = 500;
  std::uint64_t photons = 700'000;
  bool estimate = false, json = false;
  int jobs = 1;
  tools::RunOptions run;
};

void remove_left_overs(tools::Tool& tool, const Options& options) {
  const tools::Tidied short_runs = tools::tidy_folders(tools::short_run_stem());
  tools::Tidied tidied = tools::tidy(options.tidy_folder, options.tidy_hours * 3600);
  tidied.removed += short_runs.removed;
  tidied.kept += short_runs.kept;
  tidied.bytes += short_runs.bytes;
  std::cout << "removed " << tidied.removed << " unfinished files of " << tidied.bytes << " bytes, kept " << tidied.kept
            << " that may still be written\n";
  tool.stats().count("removed", double(tidied.removed));
}

/// The plan as files; of those whose content would be the same only plan.mk is written.
void write_plan(tools::Tool& tool, const Plan& plan, const std::vector<std::string>& files, const Options& options,
                tools::Output& makefile, const std::string& estimate) {
  const std::string rules = plan_makefile(plan, options.folder, files);
  std::size_t changed = 0;
  const std::vector<PlanFile> states = state_files(plan);
  for (const PlanFile& state : states) changed += write_if_changed(options.folder + "/" + state.name, state.content);
  const std::string scene_name = std::filesystem::path(options.scene).filename().string();
  write_if_changed(options.folder + "/plan.json", plan_json(plan, scene_name, tool.history_line(), estimate));
  makefile.write(rules.data(), rules.size());
  makefile.commit();  // last: from here on the plan is up to date
  tool.stats().count("state_files", double(states.size()));
  tool.stats().count("state_files_changed", double(changed));
}

/// body(lights): they aim photons where the camera looks, as those of photon-trace.
template <class Body>
void with_aimed_lights(const Tracer& tracer, tools::SceneInput& input, const CameraView& view, const Body& body) {
  EmissionTable emission = input.emission(tracer.frame().frame);
  std::vector<WeighedPlace> places;
  add_seen_places(tracer, view, 0, places);
  emission.aim = tools::spheres_in_scene(spheres_around(places, emission.sphere_radius), tracer.frame().origin);
  body(Lights(tracer.frame(), emission));
}

/// Paths, beside a map of caustic photons if that pays, or what photons ask for if paths do not find what indirect light there is.
void decide_beside_paths(const RenderScene& scene, const CameraView& view, const IndirectPilot& paths, const IndirectChoice& choice, Plan& plan) {
  const SeenPhotons caustic = see_photons(scene, view, "caustic", 0);
  const CausticChoice map = choose_caustics(paths, caustic);
  if (map.map) {
    const IndirectChoice beside = choose_beside_caustics(paths, caustic, see_photons(scene, view, "indirect", 0));
    if (beside.method != IndirectMethod::paths) return use_indirect(plan, kIndirectMethods[std::size_t(beside.method)], beside.because);
  }
  use_indirect(plan, "paths", choice.because + "; " + map.because, map.map);
}

/// Decides how indirect light is to be found by a pilot of a frame; not if surfaces scatter no light there and `unless_dark`: false.
bool decide_by_pilot(tools::SceneInput& input, const Options& options, int camera, int number, bool unless_dark, Plan& plan) {
  const SceneFrame frame = input.at(number);
  const CameraView view(frame.camera(camera), frame.origin, options.run.width, options.run.height);
  const Tracer tracer(frame);
  const Lights lights(frame, input.emission(frame.frame));
  const IndirectPilot pilot = pilot_indirect({tracer, lights}, view, options.pixel_error, 0);
  if (unless_dark && !(pilot.scattered > 0)) return false;
  plan.record_rays = record_rays(pilot, options.rays);
  plan.learn_lights = lights.has_distant() && pilot.open_share <= kMostOpen;
  const IndirectChoice choice = choose_indirect(pilot);
  const std::string method = kIndirectMethods[std::size_t(choice.method)];
  if (plan.media && method == "paths") {
    use_indirect(plan, "gather", "photons light the media, points read them, too");
  } else if (choice.method != IndirectMethod::paths || plan.photon_kinds.find("caustic") == std::string::npos) {
    use_indirect(plan, method, choice.because);
  } else {
    with_aimed_lights(tracer, input, view, [&](const Lights& aimed) { decide_beside_paths({tracer, aimed}, view, pilot, choice, plan); });
  }
  if (plan.indirect != "paths" && lights.has_distant())
    with_aimed_lights(tracer, input, view, [&](const Lights& aimed) {
      plan.photon_paths = photon_paths(pilot_arrivals({tracer, aimed}, plan.photon_kinds, 0), options.photons);
    });
  return true;
}

/// Decides how indirect light is to be found: as asked, or by a pilot of the middle one of the frames asked for; if that is dark, of the first or last.
void decide_indirect(tools::Tool& tool, tools::SceneInput& input, const Options& options, int camera, Plan& plan) {
  plan.learn_lights = !plan.photon_kinds.empty();
  if (plan.photon_kinds.empty()) return;
  plan.record_rays = options.rays;
  plan.photon_paths = options.photons;
  if (options.indirect != "auto") return use_indirect(plan, options.indirect, "--indirect " + options.indirect);
  tool.stats().phase("pilot", true);
  std::vector<int> numbers{plan.frames[plan.frames.size() / 2]};
  for (const int number : {plan.frames.front(), plan.frames.back()})
    if (std::ranges::find(numbers, number) == numbers.end()) numbers.push_back(number);
  for (const int number : numbers)
    if (decide_by_pilot(input, options, camera, number, number != numbers.back(), plan)) return;
}

/// Decides what of a frame's light follows from that of what stands: as asked, or by a pilot. What it then costs is noted for the
/// estimate.
void decide_moving(tools::Tool& tool, tools::SceneInput& input, Options& options, int camera, Plan& plan) {
  const UpdatableLight light = updatable_light(plan);
  if (plan.photon_kinds.empty() || plan.indirect == "paths") return;
  if (light.segments == 0)
    return use_moving(plan, "anew", "no segment has " + std::to_string(kFewestStates) + " states of light");
  if (plan.media && options.moving != "auto" && options.moving != "anew")
    throw InputError("--moving " + options.moving + ": the scene has media, which all light meets: what movers change of it cannot be told apart; "
                     "use --moving anew");
  if (plan.media && options.moving == "auto") return use_moving(plan, "anew", "there are media, which all light meets");
  if (options.moving == "anew") return use_moving(plan, "anew", "--moving anew");
  tool.stats().phase("pilot of what moves", true);
  const SceneFrame frame = input.at(light.frame);
  const CameraView view(frame.camera(camera), frame.origin, options.run.width, options.run.height);
  MovingChoice choice = choose_moving(pilot_moving(frame, input.emission(frame.frame), view, 0), light.segments, light.states);
  if (options.moving != "auto") {
    choice.because = "--moving " + options.moving;
    choice.method = options.moving == "light"     ? MovingMethod::light
                    : options.moving == "records" ? MovingMethod::records
                                                  : MovingMethod::time;
  }
  options.run.moving_cost = choice.cost;
  use_moving(plan, kMovingMethods[std::size_t(choice.method)], choice.because);
}

/// Are bright points to be divided from the others: as asked, or by a pilot of the middle one of the frames asked for.
SplitChoice split_choice(tools::Tool& tool, tools::SceneInput& input, const Options& options, int camera, const Plan& plan) {
  if (plan.photon_kinds.empty() || plan.indirect == "paths") return {false, ""};
  if (options.split != "auto") return {options.split == "on", "--split " + options.split};
  tool.stats().phase("pilot of bright spots", true);
  const SceneFrame frame = input.at(plan.frames[plan.frames.size() / 2]);
  const CameraView view(frame.camera(camera), frame.origin, options.run.width, options.run.height);
  return choose_split(pilot_split(frame, input.emission(frame.frame), view, 0));
}

void plan_range(tools::Tool& tool, Options& options, bool write) {
  while (options.folder.size() > 1 && options.folder.back() == '/') options.folder.pop_back();
  std::optional<tools::Output> makefile;
  if (write) {
    check_folder_name(options.folder);
    make_folder(options.folder + "/state");
    makefile.emplace(options.folder + "/plan.mk", false, tools::Output::Kind::text);
  }
  tool.stats().phase("load");
  tools::SceneInput input(tool, options.scene, tools::SceneInput::light | tools::SceneInput::a_camera);
  const Scene& scene = input.scene();

  tool.stats().phase("plan");
  const int camera = scene.camera_node(tool.common().camera);
  const MediaHash media = [&](int frame) { return input.media_hash(frame); };
  Plan plan = make_plan(scene, tool.common().frames, camera, input.time(), input.has_media() ? media : MediaHash{});
  decide_indirect(tool, input, options, camera, plan);
  const SplitChoice split = split_choice(tool, input, options, camera, plan);
  decide_moving(tool, input, options, camera, plan);
  use_split(plan, split.split, split.because);
  for (const std::string& warning : plan.warnings) tool.warn(options.scene + ": " + warning);
  if (write && !plan.photon_kinds.empty()) {
    tool.stats().phase("views", true);
    tools::plan_views(input, camera, options.run.width, options.run.height, plan);
  }
  std::string estimate_as_json;
  if (options.estimate) {
    tool.stats().phase("estimate");
    const int processors = usable_processor_count(), threads = tool.common().threads;
    options.run.threads = threads;
    options.run.progress = [&](double done) { tool.progress(done); };
    const Estimate estimate = tools::estimate_run(options.scene, plan, options.run);
    estimate_as_json = estimate_json(estimate, processors, options.jobs, threads);
    std::cout << (options.json ? estimate_as_json : estimate_text(estimate, processors, options.jobs, threads));
  }
  tool.stats().phase("write");
  if (makefile && plan.media)
    for (const PlannedSegment& segment : plan.segments)
      write_if_changed(options.folder + "/state/majorants." + frame_digits(segment.first),
                       majorants_text(input.frozen_majorants(segment.first, segment.last)));
  std::vector<std::string> files = scene.files;
  files.insert(files.end(), input.media_files().begin(), input.media_files().end());
  if (makefile) write_plan(tool, plan, files, options, *makefile, estimate_as_json);
  for (const Stage& stage : plan.stages)
    tool.say(stage.name + (stage.needed ? ": needed: " : ": not needed: ") + stage.because);
}

}  // namespace

int main(int argc, char** argv) {
  tools::Tool tool("scene-plan", "Say what a range of frames needs, as make variables and state files.", argc,
                   argv);
  Options options;
  CLI::App& app = tool.app();
  app.add_option("scene", options.scene, "glTF scene, .gltf or .glb; needed but for --tidy");
  const CLI::Option* output = tool.output_option(options.folder,
                                                 "folder for plan.json, plan.mk and state/; with --estimate "
                                                 "only if it is given")
                                  ->capture_default_str();
  app.add_option("--indirect", options.indirect,
                 "how indirect light is found: records, gather (in the pixel, by points), paths; auto: the cheapest by a pilot")
      ->capture_default_str()
      ->check(CLI::IsMember({"auto", "records", "gather", "paths"}));
  app.add_option("--pixel-error", options.pixel_error,
                 "of the frames (frame-render --pixel-error): records get as many gather rays as leave their light about a tenth of that")
      ->capture_default_str()
      ->check(tools::number_between(1e-6, 10));
  app.add_option("--rays", options.rays, "gather rays of a record (irradcache-build records --rays) at most")
      ->capture_default_str()
      ->check(tools::number_between(1, 1 << 20));
  tool.count_option("--photons", options.photons,
                    "paths of light of a photon map (photon-trace --photons); up to 16 times as many where a pilot finds that few of them arrive");
  app.add_option("--moving", options.moving,
                 "what of a frame's light follows from that of what stands, where something moves: anew (nothing), light (photons and "
                 "points), records (they, too), time (photons and points; records keep their incoming light from frame to frame); auto: the cheapest by a pilot")
      ->capture_default_str()
      ->check(CLI::IsMember({"auto", "anew", "light", "records", "time"}));
  app.add_option("--split", options.split,
                 "are bright points divided from the others and sampled explicitly: on, off; auto: where a pilot finds that it pays")
      ->capture_default_str()
      ->check(CLI::IsMember({"auto", "on", "off"}));
  const auto add = [&](CLI::Option* option) {
    tool.leave_out_of_history(option);
    return option;
  };
  add(app.add_flag(
      "--estimate", options.estimate,
      "print what the run will cost: CPU seconds and bytes of each stage, from short runs on this machine"));
  add(app.add_flag("--json", options.json, "print the estimate as JSON"));
  tool.leave_out_of_history(
      tool.size_option("--size", options.run.width, options.run.height,
                       "size of the frames to estimate, pixels, unless the options below say it"));
  add(app.add_option("--photon-options", options.run.photons, "options photon-trace will get, as one word"))
      ->type_name("TEXT");
  add(app.add_option("--point-options", options.run.points, "options irradcache-build points will get"))
      ->type_name("TEXT");
  add(app.add_option("--cache-options", options.run.cache, "options irradcache-build records will get"))
      ->type_name("TEXT");
  add(app.add_option("--frame-options", options.run.frames, "options frame-render will get"))->type_name("TEXT");
  add(app.add_option("--jobs", options.jobs, "processes at a time to estimate for, as make -j"))
      ->type_name("N")->capture_default_str()->check(tools::number_between(1, 100000));
  add(app.add_option(
          "--tidy", options.tidy_folder,
          "instead: remove unfinished files of killed runs from this folder and those in it, and from the folder "
          "for temporary files what killed --estimate left"))
      ->type_name("FOLDER");
  add(app.add_option("--tidy-hours", options.tidy_hours,
                     "unfinished files of other hosts count as left over after so many hours"))
      ->type_name("HOURS")
      ->capture_default_str()
      ->check(tools::number_between(0));
  tool.common_options(tools::uses_scene | tools::uses_camera | tools::uses_frames);

  return tool.run([&] {
    if (options.tidy_folder.empty() && options.scene.empty())
      throw InputError("scene is required; see scene-plan --help");
    if (!options.tidy_folder.empty()) {
      if (!options.scene.empty()) throw InputError("--tidy FOLDER needs no scene; leave it out");
      remove_left_overs(tool, options);
    } else {
      plan_range(tool, options, !options.estimate || output->count() > 0);
    }
    return int(tools::exit_ok);
  });
}
