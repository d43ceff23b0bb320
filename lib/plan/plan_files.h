// lib/plan/plan_files.h -- a plan as files: plan.json for people and scripts, plan.mk for make (formats/plan/plan.md).
#pragma once

#include <string>

#include "lib/plan/graph.h"

namespace tempolux {

std::string plan_json(const Plan& plan, const Graph& graph, const std::string& scene_name, const std::string& history);

/// Names of our own files only: nothing in it comes from the scene, or from file names of the user.
std::string plan_makefile(const Plan& plan, const Graph& graph, const ToolHash& tool_hash);

/// Decisions as JSON, and back. InputError for text that is not that.
std::string decisions_text(const Decisions& decisions);
Decisions read_decisions(const std::string& text);

}  // namespace tempolux
