// lib/plan/graph.h -- the files that a plan needs, and what each is made from.
//
// A file's name ends in a key: a hash of everything that it is made from, namely the program, its options, the states
// of the scene that it depends on, and the names of its inputs, which have keys of their own. So a file that exists
// under the name asked for is right, whatever was made before in the same folder and whatever the clocks of machines
// say.
#pragma once

#include <functional>
#include <map>
#include <string>
#include <vector>

#include "lib/plan/plan.h"
#include "lib/plan/stages.h"

namespace tempolux {

/// A file that a rule of pipelines/stages.mk makes.
struct GraphFile {
  std::string name;                 ///< relative to OUT: "photons/0012-3fa94c21d0.photons"
  std::vector<std::string> beside;  ///< further files that the same command writes
  std::string stage;                ///< StageInfo::name
  std::string words;                ///< options of the command, inputs included
  bool passing = false;             ///< read once and large: removed by the command that reads it
  std::vector<std::string> inputs;  ///< names of files that must exist before
};

/// A small file that scene-plan writes itself: name relative to OUT, and its bytes.
struct PlanFile {
  std::string name;
  std::string content;
};

struct Graph {
  std::vector<GraphFile> files;                ///< inputs before what is made from them
  std::map<std::string, std::size_t> by_name;  ///< of all files, those beside others included, the place in `files`
  std::vector<PlanFile> states;                ///< view files, majorants
  std::map<int, std::string> pictures;         ///< of each frame asked for, the file that it shows
  std::vector<std::string> intervals;          ///< of a walkthrough, in the order of frames
  std::map<int, std::string> errors;           ///< of each frame of the report: what aqm-compare finds
  std::map<std::string, std::vector<std::string>>
      spent;  ///< of each file of the report: stats of all stages that lead to it

  void add(const GraphFile& file);
  const GraphFile* find(const std::string& name)
      const;  ///< the file that the command makes which makes this one; nullptr: no command makes it
};

/// Hash of a program and of all that it loads.
using ToolHash = std::function<std::string(const std::string& tool)>;
/// Content of a majorants file for the segment that starts at `first` (formats/majorants); called only where there are
/// media.
using MajorantsText = std::function<std::string(int first, int last)>;

/// `wish` is complete (with_preset). Throws InputError for wishes that exclude each other.
Graph make_graph(const Plan& plan, const Wish& wish, const ToolHash& tool_hash, const MajorantsText& majorants);

/// Frames beside those asked for whose segments the graph needs: windows of the filter, keys of a walkthrough, and
/// those beside them where pictures say how things move.
std::vector<int> helper_frames(const std::vector<int>& frames, const Wish& wish);

/// "photons/0012-3fa94c21d0" of "photons/0012-3fa94c21d0.photons"; with another extension; the digits of a key, 40
/// bits: two of 10 000 files agree by chance once in 20 000 plans.
std::string stem_of(const std::string& name);
std::string beside(const std::string& name, const std::string& extension);
std::string key_of(const std::string& hash);
/// A frame number as it stands in names: at least four digits.
std::string frame_digits(int frame);

}  // namespace tempolux
