// tools/stages/planning.h -- the work of scene-plan: checks whether anything changed, plans, and writes the plan's
// files.
#pragma once

#include <array>
#include <set>
#include <string>
#include <vector>

#include "lib/plan/inputs.h"
#include "lib/plan/plan_files.h"
#include "tools/common/scene_input.h"

namespace tempolux::tools {

/// A plan and its graph, before they are written.
struct Planned {
  Plan plan;
  Graph graph;
  PlanContext context;
  std::vector<std::string> warnings;  ///< warnings about the scene
};

/// The folder of a plan and of all files that the plan names.
class PlanFolder {
 public:
  /// Creates the folder. Throws ResourceError if it cannot.
  explicit PlanFolder(std::string path);

  Inputs& inputs() { return inputs_; }
  /// True if the folder holds a plan that was made for this wish, and none of the plan's inputs has changed since.
  bool up_to_date(const std::string& wish);
  /// The decisions for a segment: those of an earlier plan with the same key, else those of `decide`, which are stored
  /// for later plans.
  Decisions decisions(const PlannedSegment& segment, const std::string& key, const std::function<Decisions()>& decide);
  /// Costs of a command of each stage: as `make estimate` has measured them for pictures of this size, else those of
  /// the table of stages.
  StageCosts costs(int width, int height) const;
  /// Writes plan.json, plan.mk and state/. Removes files that no kept plan names (keep).
  void write(const Planned& planned, const ToolHash& tool_hash, const std::string& wish, const std::string& shot);

 private:
  /// Adds names to the list of the files of this shot: of all plans that have had the same wish and inputs, for any
  /// frames. Keeps this list and those of the two shots before. Returns all names in them.
  std::set<std::string> keep(const std::string& shot, std::set<std::string> names);

  std::string path_;
  Inputs inputs_;
  std::vector<std::string> decided_;  ///< files that decisions() has read or written
};

/// Plans the requested frames. All files that it reads become inputs of the folder.
class Planner {
 public:
  /// Reads the scene. `folder`: nullptr if nothing is kept. `recipes`: the files with the rules.
  Planner(Tool& tool, const std::string& scene, const Wish& wish, const std::vector<std::string>& recipes,
          PlanFolder* folder);

  const Planned& planned() const { return planned_; }
  const ToolHash& tool_hash() const { return tool_hash_; }
  /// The graph for a changed plan or wish.
  Graph graph(const Plan& plan, const Wish& wish);

 private:
  /// Makes the decisions of the shot and of each segment of planned_.plan. The folder, if any, keeps them.
  void decide_segments(Tool& tool, const Wish& wish, int camera, PlanFolder* folder);
  /// Stores the hashes of all files of the scene and of its media.
  void note_inputs(Inputs& inputs) const;

  Inputs none_{""};
  ToolHash tool_hash_;  ///< of the programs in this program's folder, with all modules and with `recipes`
  SceneInput input_;
  Planned planned_;
};

/// Options that all stages share and that are not part of the scene's states: they enter the keys as typed. Input
/// files, segments and the choice of an animation are part of the states.
inline constexpr std::array kSharedWords{"--fps", "--allow-stale"};

/// Throws InputError, naming the option, unless the words consist of letters, digits, blanks and . , : + - _ % /. They
/// are written to plan.mk, where other characters have a meaning.
void check_words(const std::string& option, const std::string& words);

}  // namespace tempolux::tools
