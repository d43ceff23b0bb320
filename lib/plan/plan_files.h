// lib/plan/plan_files.h -- writes a plan as files: plan.json for people and scripts, plan.mk for make
// (formats/plan/plan.md).
#pragma once

#include <map>
#include <string>
#include <vector>

#include "lib/plan/estimate.h"
#include "lib/plan/graph.h"

namespace tempolux {

/// The options of commands that are not part of GraphFile::words, and the costs of the commands. Names may hold any
/// byte.
struct PlanContext {
  std::string scene;                 ///< the scene's file, an absolute name
  std::vector<std::string> options;  ///< of all stages that read the scene
  std::string camera;                ///< name of the camera, or auto
  std::vector<std::string> lens;     ///< options of the camera's lens, of all stages that read the camera
  StageCosts costs;                  ///< of one command of each stage
  std::string history;
};

/// The whole command of a file: the program, its options, the outputs. Empty for files that walkthrough.sh makes.
std::vector<std::string> command_of(const GraphFile& file, const PlanContext& context);

/// The text of plan.json.
std::string plan_json(const Plan& plan, const Graph& graph, const PlanContext& context);

/// The text of plan.mk. It holds names of generated files only: no text from the scene and no file name of the user.
std::string plan_makefile(const Plan& plan, const Graph& graph, const ToolHash& tool_hash);

/// Decisions as JSON text, and the inverse, which throws InputError for invalid text.
std::string decisions_text(const Decisions& decisions);
Decisions read_decisions(const std::string& text);

}  // namespace tempolux
