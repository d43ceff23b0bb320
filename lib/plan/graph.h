// lib/plan/graph.h -- the files that a plan needs, and the inputs of each.
//
// A file's name ends in a key: a hash of the program, its options, the scene's states that the file depends on, and
// the names of its inputs, which end in keys themselves. So an existing file with the wanted name has the right
// content. Other files in the folder and file times do not matter.
#pragma once

#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "lib/plan/plan.h"
#include "lib/plan/stages.h"

namespace tempolux {

/// A file that a command of a stage makes.
struct GraphFile {
  std::string name;                 ///< relative to OUT: "photons/0012-3fa94c21d0.photons"
  std::vector<std::string> beside;  ///< further files of the same command
  const StageInfo* stage = nullptr;
  std::string words;                ///< options of the command, inputs included
  bool passing = false;             ///< large: removed when all files that are made from it are there
  std::vector<std::string> inputs;  ///< names of files that must exist first
};

/// A small file that scene-plan writes itself: its name relative to OUT, and its bytes.
struct PlanFile {
  std::string name;
  std::string content;
};

/// All files that a plan needs.
struct Graph {
  std::vector<GraphFile> files;                ///< inputs come before the files made from them
  std::map<std::string, std::size_t> by_name;  ///< index into `files` of every file, including those in `beside`
  std::vector<PlanFile> states;                ///< view files, majorants
  std::map<int, std::string> pictures;         ///< the picture that each frame asked for shows
  std::optional<double> exposure;              ///< of the previews, stops; empty: chosen for the first picture
  std::vector<std::string> intervals;          ///< of a walkthrough, in frame order
  std::map<int, std::string> errors;           ///< result of aqm-compare for each frame of the report
  /// For each file in `errors`: the statistics of all commands that lead to the judged picture.
  std::map<std::string, std::vector<std::string>> spent;

  void add(const GraphFile& file);
  /// The entry whose command writes this file; nullptr if no command does.
  const GraphFile* find(const std::string& name) const;
};

/// Hash of a program and of the modules and child programs it uses.
using ToolHash = std::function<std::string(const std::string& tool)>;
/// Content of a majorants file for the segment of frames first to last (formats/majorants); called only if there are
/// media.
using MajorantsText = std::function<std::string(int first, int last)>;

/// The files of the requested pictures and of the report. `wish` must be complete (with_preset). Throws InputError for
/// wishes that exclude each other.
Graph make_graph(const Plan& plan, const Wish& wish, const ToolHash& tool_hash, const MajorantsText& majorants);

/// Frames whose segments must be planned so that the graph can make `frames`: the frames of filter windows, the keys of
/// a walkthrough, and the neighbours of all of these if pictures hold motion.
std::vector<int> helper_frames(const std::vector<int>& frames, const Wish& wish);

/// The words of a text that blanks separate.
std::vector<std::string> words_of(std::string_view text);
/// A file's name without its extension: "photons/0012-3fa94c21d0" for "photons/0012-3fa94c21d0.photons".
std::string stem_of(const std::string& name);
/// The same name with another extension.
std::string beside(const std::string& name, const std::string& extension);
/// The digits of a key: 40 bits of the hash. Among 10 000 files two keys are equal by chance once in 20 000 plans.
std::string key_of(const std::string& hash);
/// A frame number as in file names: at least four digits.
std::string frame_digits(int frame);

}  // namespace tempolux
