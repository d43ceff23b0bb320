// tools/scene-plan.cpp -- say what a range of frames needs, as make variables and state files.
//
//     scene-plan room.glb --frames 0-47 -o plan
//
// Writes plan/plan.json, plan/plan.mk and plan/state/*. A file whose content would be the same is left
// untouched, except plan.mk, which make wants newer than the scene. Format: formats/plan/plan.md.
#include <CLI/CLI.hpp>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include "formats/error.h"
#include "lib/plan/plan_files.h"
#include "tools/scene_input.h"

using namespace tempolux;

namespace {

void make_folder(const std::string& folder) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error) throw ResourceError(folder + ": cannot create this folder: " + error.message());
}

/// Returns true if the file was new or different.
bool write_if_changed(const std::string& path, const std::string& content) {
  std::ifstream present(path, std::ios::binary);
  if (present && std::string(std::istreambuf_iterator<char>(present), {}) == content) return false;
  tools::Output output(path, false, tools::Output::Kind::text);
  output.write(content.data(), content.size());
  output.commit();
  return true;
}

}  // namespace

int main(int argc, char** argv) {
  tools::Tool tool("scene-plan", "Say what a range of frames needs, as make variables and state files.", argc,
                   argv);
  std::string scene_file, folder = "plan";
  tool.app().add_option("scene", scene_file, "glTF scene, .gltf or .glb")->required();
  tool.output_option(folder, "folder for plan.json, plan.mk and state/")->capture_default_str();
  tool.common_options(tools::uses_scene | tools::uses_camera | tools::uses_frames);

  return tool.run([&] {
    while (folder.size() > 1 && folder.back() == '/') folder.pop_back();
    check_folder_name(folder);
    make_folder(folder + "/state");
    tools::Output makefile(folder + "/plan.mk", false, tools::Output::Kind::text);

    tool.stats().phase("load");
    const tools::SceneInput input(tool, scene_file, tools::SceneInput::light | tools::SceneInput::a_camera);
    const Scene& scene = input.scene();

    tool.stats().phase("plan");
    const int camera = scene.camera_node(tool.common().camera);
    const Plan plan = make_plan(scene, tool.common().frames, camera, input.time());
    for (const std::string& warning : plan.warnings) tool.warn(scene_file + ": " + warning);

    tool.stats().phase("write");
    const std::string rules = plan_makefile(plan, folder, scene.files);
    std::size_t changed = 0;
    const std::vector<PlanFile> states = state_files(plan);
    for (const PlanFile& state : states)
      changed += write_if_changed(folder + "/" + state.name, state.content);
    const std::string scene_name = std::filesystem::path(scene_file).filename().string();
    write_if_changed(folder + "/plan.json", plan_json(plan, scene_name, tool.history_line()));
    makefile.write(rules.data(), rules.size());
    makefile.commit();  // last: from here on the plan is up to date

    tool.stats().count("state_files", double(states.size()));
    tool.stats().count("state_files_changed", double(changed));
    for (const Stage& stage : plan.stages)
      tool.say(stage.name + (stage.needed ? ": needed: " : ": not needed: ") + stage.because);
    return int(tools::exit_ok);
  });
}
