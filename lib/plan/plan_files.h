// lib/plan/plan_files.h -- a plan as files: plan.json, plan.mk and the state files (formats/plan/plan.md).
#pragma once

#include <string>
#include <vector>

#include "lib/plan/plan.h"

namespace tempolux {

/// A small file: name relative to the plan's folder, and its bytes.
struct PlanFile {
  std::string name;
  std::string content;
};

/// plan.json: everything, for people and scripts.
/// `estimate`: estimate_json(), or empty.
std::string plan_json(const Plan& plan, const std::string& scene_name, const std::string& history,
                      const std::string& estimate = {});

/// Throws InputError if make cannot name files in a folder of this name (blanks, '%', ':' ...).
void check_folder_name(const std::string& folder);

/// plan.mk: make variables, and plan.mk's own prerequisites, the `scene_files`. `folder` is the plan's folder
/// as make shall name it; checked as above.
std::string plan_makefile(const Plan& plan, const std::string& folder,
                          const std::vector<std::string>& scene_files);

/// state/CONCERN.FFFF: one hash per line; state/view.SSSS: spheres. To be rewritten only when their content differs.
std::vector<PlanFile> state_files(const Plan& plan);

/// A frame number as it stands in names: at least four digits.
std::string frame_digits(int frame);

}  // namespace tempolux
