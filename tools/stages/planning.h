// tools/stages/planning.h -- what scene-plan does: looks whether anything changed, plans, and writes the plan's files.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "lib/plan/graph.h"
#include "lib/plan/inputs.h"
#include "tools/common/scene_input.h"

namespace tempolux::tools {

/// A plan and its files, before they are written.
struct Planned {
  Plan plan;
  Graph graph;
  std::string scene_name;
  std::vector<std::string> warnings;  ///< that were given for the scene
};

/// The folder that a plan lies in, which is the folder of all files that it names.
class PlanFolder {
 public:
  /// Makes the folder. Throws ResourceError if it cannot.
  explicit PlanFolder(std::string path);

  Inputs& inputs() { return inputs_; }
  /// Whether the plan in the folder is that of this wish and nothing that it was made from has changed.
  bool up_to_date(const std::string& wish);
  /// The decisions for a segment: those that an earlier plan made for the same content, else `decide` makes them and
  /// they are kept.
  Decisions decisions(const PlannedSegment& segment, const std::string& key, const std::function<Decisions()>& decide);
  /// Writes plan.json, plan.mk and state/. Removes files that neither this plan nor the two before it name.
  void write(const Planned& planned, const ToolHash& tool_hash, const std::string& wish, const std::string& history);

 private:
  std::string path_;
  Inputs inputs_;
  std::vector<std::string> decided_;  ///< files that decisions() has read or written
};

/// Plans the frames asked for. The files that it reads become inputs of the folder.
class Planner {
 public:
  /// Reads the scene. `folder`: nullptr if nothing is to be kept. `recipes`: files that hold the rules.
  Planner(Tool& tool, const std::string& scene, const Wish& wish, const std::vector<std::string>& recipes,
          PlanFolder* folder);

  const Planned& planned() const { return planned_; }
  const ToolHash& tool_hash() const { return tool_hash_; }
  /// The files for other decisions or another wish.
  Graph graph(const Plan& plan, const Wish& wish);

 private:
  Inputs none_{""};
  ToolHash tool_hash_;  ///< of the programs beside this one, with all modules and with `recipes`
  SceneInput input_;
  Planned planned_;
};

/// Options that all stages share and that no state of the scene holds: they are a part of what files are made from, as
/// typed. What names of files stand for, segments and the choice of an animation is in the states.
inline constexpr std::array kSharedWords{"--fps", "--reduce-textures", "--max-texture", "--allow-outside",
                                         "--allow-stale"};

/// Throws InputError, naming the option, unless the words are letters, digits, blanks and . , : + - _ % /: they stand
/// in plan.mk, where other characters would mean something.
void check_words(const std::string& option, const std::string& words);

}  // namespace tempolux::tools
