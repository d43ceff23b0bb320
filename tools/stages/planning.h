// tools/stages/planning.h -- what scene-plan does: looks whether anything changed, plans, and writes the plan's files.
#pragma once

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
  std::vector<std::string> warnings;   ///< that were given for the scene
};

/// The folder that a plan lies in, which is the folder of all files that it names.
class PlanFolder {
 public:
  /// Makes the folder. Throws ResourceError if it cannot.
  explicit PlanFolder(std::string path);

  Inputs& inputs() { return inputs_; }
  /// Whether the plan in the folder is that of this wish and nothing that it was made from has changed.
  bool up_to_date(const std::string& wish);
  /// The decisions for a segment: those that an earlier plan made for the same content, else `decide` makes them and they are kept.
  Decisions decisions(const PlannedSegment& segment, const std::string& key, const std::function<Decisions()>& decide);
  /// Writes plan.json, plan.mk and state/. Removes files that neither this plan nor the two before it name.
  void write(const Planned& planned, const ToolHash& tool_hash, const std::string& wish, const std::string& history,
             const std::string& estimate);

 private:
  std::string path_;
  Inputs inputs_;
  std::vector<std::string> decided_;   ///< files that decisions() has read or written
};

/// Hashes of the programs beside this one, with all modules and with `recipes`.
ToolHash tool_hashes(Inputs& inputs, const std::vector<std::string>& recipes);

/// Plans. Reads the scene; the inputs become those of the folder. `folder`: nullptr if nothing is to be kept.
Planned make_planned(Tool& tool, const std::string& scene, Wish& wish, const ToolHash& tool_hash, PlanFolder* folder);

/// Options of the command line that all stages share, as words: --fps, --environment ..., each with its value.
std::vector<std::string> shared_arguments(const Common& common);

/// Throws InputError, naming the option, unless the words are letters, digits, blanks and . , : + - _ % /: they stand in
/// plan.mk, where other characters would mean something.
void check_words(const std::string& option, const std::string& words);

}  // namespace tempolux::tools
