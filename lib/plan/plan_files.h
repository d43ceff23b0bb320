// lib/plan/plan_files.h -- writes a plan as files: plan.json for people and scripts, plan.mk for make
// (formats/plan/plan.md).
#pragma once

#include <string>

#include "lib/plan/graph.h"

namespace tempolux {

/// The text of plan.json.
std::string plan_json(const Plan& plan, const Graph& graph, const std::string& scene_name, const std::string& history);

/// The text of plan.mk. It holds names of generated files only: no text from the scene and no file name of the user.
std::string plan_makefile(const Plan& plan, const Graph& graph, const ToolHash& tool_hash);

/// Decisions as JSON text, and the inverse, which throws InputError for invalid text.
std::string decisions_text(const Decisions& decisions);
Decisions read_decisions(const std::string& text);

}  // namespace tempolux
