#include "tools/stages/planning.h"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <set>
#include <sstream>

#include "formats/error.h"
#include "formats/hash.h"
#include "lib/core/json.h"
#include "lib/core/json_file.h"
#include "lib/core/module_folders.h"
#include "lib/plan/decide.h"
#include "lib/volume/majorants_file.h"

namespace tempolux::tools {
namespace {

namespace fs = std::filesystem;

/// Earlier shots whose files are kept, so that going back to an earlier wish makes nothing again.
constexpr int kPlansKept = 2;

void make_folder(const std::string& folder) {
  std::error_code error;
  fs::create_directories(folder, error);
  if (error) throw ResourceError(folder + ": cannot create this folder: " + error.message());
}

std::string content_of(const std::string& path) {
  std::ifstream stream(path, std::ios::binary);
  return std::string(std::istreambuf_iterator<char>(stream), {});
}

void write_whole(const std::string& path, const std::string& content) {
  Output output(path, Output::Kind::text);
  output.write(content.data(), content.size());
  output.commit_unsynced();
}

void write_if_changed(const std::string& path, const std::string& content) {
  if (!fs::exists(path) || content_of(path) != content) write_whole(path, content);
}

/// Names of a plan's files without extension: files in `beside` share the name.
std::set<std::string> stems(const Graph& graph, const std::vector<std::string>& others) {
  std::set<std::string> names(others.begin(), others.end());
  for (const GraphFile& file : graph.files) names.insert(stem_of(file.name));
  for (const PlanFile& state : graph.states) names.insert(stem_of(state.name));
  return names;
}

/// True if a name looks like those of make_graph: "0012-3fa94c21d0".
bool has_key(const std::string& stem) {
  const std::size_t dash = stem.rfind('-');
  if (dash == std::string::npos || stem.size() - dash != 11 || dash < 4) return false;
  const auto all_in = [](const std::string& text, const char* allowed) {
    return text.find_first_not_of(allowed) == std::string::npos;
  };
  return all_in(stem.substr(0, dash), "0123456789+") && all_in(stem.substr(dash + 1), "0123456789abcdef");
}

/// Removes files from the stages' folders that no kept plan names. Files with other names stay.
void remove_expired(const std::string& folder, const std::set<std::string>& named) {
  std::set<std::string> folders{"state"};
  for (const StageInfo& stage : kStages) folders.insert(std::string(stage.folder));
  for (const std::string& sub : folders) {
    std::error_code error;
    for (const auto& entry : fs::directory_iterator(folder + "/" + sub, error)) {
      const std::string name = entry.path().filename().string(), stem = name.substr(0, name.find_first_of("._"));
      if (has_key(stem) && !named.contains(sub + "/" + stem)) fs::remove_all(entry.path(), error);
    }
  }
}

void add_lines(const std::string& text, std::set<std::string>& lines) {
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);) lines.insert(line);
}

/// Hashes of the programs in this program's folder, each with all modules and with `recipes`.
ToolHash tool_hashes(Inputs& inputs, const std::vector<std::string>& recipes) {
  const std::string programs = fs::read_symlink("/proc/self/exe").parent_path().string();
  Hasher shared;
  for (const std::string& recipe : recipes) shared.add(std::string_view(inputs.hash_of(recipe)));
  for (const std::string& folder : default_module_folders()) {
    std::set<std::string> modules;
    std::error_code error;
    for (const auto& entry : fs::directory_iterator(folder, error))
      if (entry.path().filename().string().starts_with("tempolux-")) modules.insert(entry.path().string());
    for (const std::string& module : modules) shared.add(std::string_view(inputs.hash_of(module)));
  }
  inputs.hash_of(programs + "/scene-plan");
  return [&inputs, programs, common = shared.hex()](const std::string& tool) {
    return inputs.hash_of(programs + "/" + tool) + common;
  };
}

/// The decisions in a file. Empty if the file does not exist, or if it is damaged, so that it is made again.
std::optional<Decisions> kept_decisions(const std::string& file) {
  const std::string text = content_of(file);
  if (text.empty()) return {};
  try {
    return read_decisions(text);
  } catch (const InputError&) { return {}; }
}

/// The shot's middle frame, if the plan decides whether frames keep its pixels; or null.
const PlannedFrame* middle_for_pixels(const Plan& plan, const Wish& wish) {
  const std::optional<int> middle = plan.middle();
  return wish.method == FrameMethod::automatic && middle ? &plan.segment_of(*middle).at(*middle) : nullptr;
}

}  // namespace

PlanFolder::PlanFolder(std::string path) : path_(std::move(path)), inputs_(path_ + "/state/inputs") {
  make_folder(path_ + "/state");
}

bool PlanFolder::up_to_date(const std::string& wish) {
  return fs::exists(path_ + "/plan.mk") && fs::exists(path_ + "/plan.json") && inputs_.unchanged(wish);
}

Decisions PlanFolder::decisions(const PlannedSegment& segment, const std::string& key,
                                const std::function<Decisions()>& decide) {
  const std::string name = "state/" + frame_digits(segment.first) + "-" + key_of(key);
  decided_.push_back(name);
  if (const std::optional<Decisions> kept = kept_decisions(path_ + "/" + name + ".decided")) return *kept;
  const Decisions decided = decide();
  write_whole(path_ + "/" + name + ".decided", decisions_text(decided));
  return decided;
}

StageCosts PlanFolder::costs(int width, int height) const {
  StageCosts costs = table_costs(width, height);
  const std::string file = path_ + "/state/costs.json";
  if (!fs::exists(file)) return costs;
  const auto measured = read_json(file);
  if (measured.at("size") == std::vector{width, height})
    for (const auto& [stage, cost] : measured.at("stages").items()) costs[stage] = {cost.at(0), cost.at(1)};
  return costs;
}

std::set<std::string> PlanFolder::keep(const std::string& shot, std::set<std::string> names) {
  const auto list = [&](std::size_t age) { return path_ + "/state/files" + (age ? "." + std::to_string(age) : ""); };
  const std::string title = "shot " + hash_hex(shot + inputs_.contents()) + "\n";
  std::vector<std::string> others;
  for (std::size_t age = 0; age <= kPlansKept; ++age) {
    const std::string text = content_of(list(age));
    if (text.starts_with(title)) add_lines(text.substr(title.size()), names);
    else if (!text.empty()) others.push_back(text);
  }
  std::string text = title;
  for (const std::string& name : names) text += name + "\n";
  write_if_changed(list(0), text);
  for (std::size_t age = 1; age <= kPlansKept && age <= others.size(); ++age) {
    write_if_changed(list(age), others[age - 1]);
    add_lines(others[age - 1], names);
  }
  return names;
}

void PlanFolder::write(const Planned& planned, const ToolHash& tool_hash, const std::string& wish,
                       const std::string& shot) {
  for (const char* sub : {"frames", "shown", "report"}) make_folder(path_ + "/" + sub);
  for (const GraphFile& file : planned.graph.files) make_folder(path_ + "/" + file.name.substr(0, file.name.find('/')));
  for (const PlanFile& state : planned.graph.states) write_if_changed(path_ + "/" + state.name, state.content);
  remove_expired(path_, keep(shot, stems(planned.graph, decided_)));
  std::string warnings;
  for (const std::string& warning : planned.warnings) warnings += warning.substr(0, warning.find('\n')) + "\n";
  write_if_changed(path_ + "/state/warnings", warnings);
  write_if_changed(path_ + "/plan.json", plan_json(planned.plan, planned.graph, planned.context));
  write_if_changed(path_ + "/plan.mk", plan_makefile(planned.plan, planned.graph, tool_hash));
  write_whole(path_ + "/state/inputs", inputs_.text(wish));  // written last: from here on the plan is up to date
}

Planner::Planner(Tool& tool, const std::string& scene, const Wish& wish, const std::vector<std::string>& recipes,
                 PlanFolder* folder)
    : tool_hash_(tool_hashes(folder ? folder->inputs() : none_, recipes)),
      input_(tool, scene, SceneInput::light | SceneInput::a_camera) {
  const int camera = input_.scene().camera_node(tool.common().camera);
  tool.stats().phase("plan");
  Plan& plan = planned_.plan;
  planned_.context = {fs::absolute(scene).string(),
                      tool.scene_words(),
                      tool.common().camera,
                      tool.lens_words(),
                      folder ? folder->costs(wish.width, wish.height) : table_costs(wish.width, wish.height),
                      tool.history_line()};
  plan = make_plan(input_.scene(), tool.common().frames, camera, input_.time(),
                   input_.has_media() ? MediaHash([&](int frame) { return input_.media_hash(frame); }) : MediaHash{},
                   helper_frames(tool.common().frames, wish),
                   {wish.shot, wish.method == FrameMethod::still || wish.method == FrameMethod::automatic});
  tool.stats().phase("pilots", true);
  decide_segments(tool, wish, camera, folder);
  tool.stats().phase("graph");
  planned_.graph = graph(plan, wish);
  for (const std::string& warning : plan.warnings) tool.warn(scene + ": " + warning);
  planned_.warnings = tool.warnings();
  if (folder) note_inputs(folder->inputs());
}

void Planner::decide_segments(Tool& tool, const Wish& wish, int camera, PlanFolder* folder) {
  Plan& plan = planned_.plan;
  const SceneSource source{[&](int frame, bool with_media) { return input_.at(frame, with_media); },
                           [&](int frame) { return input_.emission(frame); }, camera};
  const auto decided = [&](const PlannedSegment& segment, const std::string& key, const auto& make) {
    return folder ? folder->decisions(segment, hash_hex(key + tool_hash_("scene-plan")), make) : make();
  };
  std::string shot_key = "shot";
  for (const int end : plan.shot_frames) shot_key += ' ' + std::to_string(end);
  for (const PlannedSegment& piece : plan.shot) shot_key += decision_key(piece, wish, plan.media);
  std::optional<Decisions> shot;
  if (plan.shot.size() > 1)
    shot = decided(plan.shot.front(), shot_key, [&] { return decide_shot(plan.shot, wish, plan.media, source); });
  const PlannedFrame* const middle = middle_for_pixels(plan, wish);
  const auto decide_about = [&](PlannedSegment& segment) {
    tool.progress(double(&segment - plan.segments.data()) / double(plan.segments.size()));
    Wish own = wish;
    const auto measured = wish.measured.find(segment.first);
    const bool is_measured = measured != wish.measured.end();
    if (is_measured) own.photons = measured->second.photons;
    const std::string key = decision_key(segment, own, plan.media) + (shot ? shot_key : "") +
                            (middle ? middle->light + middle->camera : "");
    segment.decisions = decided(segment, key, [&] {
      Decisions d = decide(segment, own, plan.media, source, shot && !is_measured ? &*shot : nullptr);
      if (middle)
        decide_still(segment, *middle, plan.shot_frames[1] - plan.shot_frames[0] + 1, own, plan.media, source, d);
      return d;
    });
    if (is_measured) segment.decisions.reasons.push_back({"photon-trace", measured->second.because});
  };
  for (PlannedSegment& segment : plan.segments)
    if (!segment.only_pixels) decide_about(segment);
  const auto keeps = [&](const PlannedSegment& segment) { return segment.decisions.still || !middle; };
  if (std::ranges::none_of(plan.segments, keeps))
    std::erase_if(plan.segments, [](const PlannedSegment& segment) { return segment.only_pixels; });
  for (PlannedSegment& segment : plan.segments)
    if (segment.only_pixels) decide_about(segment);
}

void Planner::note_inputs(Inputs& inputs) const {
  for (const std::string& file : input_.scene().files) inputs.hash_of(file);
  for (const std::string& file : input_.media_files()) {
    inputs.hash_of(file);
    // The list of the folder's files is an input, too: a new or removed file is a change.
    inputs.hash_of(fs::absolute(file).parent_path().string());
  }
}

Graph Planner::graph(const Plan& plan, const Wish& wish) {
  return make_graph(plan, wish, tool_hash_,
                    [&](int first, int last) { return majorants_text(input_.frozen_majorants(first, last)); });
}

void check_words(const std::string& option, const std::string& words) {
  const bool fine = std::ranges::all_of(words, [](unsigned char c) {
    return std::isalnum(c) || std::string_view(" .,:+-_%/").find(char(c)) != std::string_view::npos;
  });
  if (!fine)
    throw InputError(option + ": '" + words + "': only letters, digits, blanks and . , : + - _ % / can stand there");
}

}  // namespace tempolux::tools
