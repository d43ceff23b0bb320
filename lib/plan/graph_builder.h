// lib/plan/graph_builder.h -- builds a graph. Each function adds one file and the files that it is made from, so the
// graph holds what the pictures need and nothing else.
#pragma once

#include <functional>
#include <map>
#include <string>
#include <vector>

#include "lib/plan/graph.h"

namespace tempolux {

/// The options of a command, and the files among them.
struct Command {
  std::string words;
  std::vector<std::string> inputs;
  std::string content;           ///< hashes of the scene's states that it depends on
  std::string state_words = {};  ///< further options: files of state/, which count by their content

  void option(const std::string& text) {
    if (!text.empty()) words += (words.empty() ? "" : " ") + text;
  }
  void file(const std::string& option_name, const std::string& name) {
    if (name.empty()) return;
    option(option_name.empty() ? name : option_name + " " + name);
    inputs.push_back(name);
  }
  /// A file of state/. Its name holds the first frame of the segment, on which the result does not depend.
  void state_file(const std::string& option_name, const std::string& name) {
    state_words += " " + option_name + " " + name;
    content += name.substr(name.find('-'));
    inputs.push_back(name);
  }
};

struct GraphBuilder {
  const Plan& plan;
  const Wish& wish;
  const ToolHash& tool_hash;
  const MajorantsText& majorants;
  std::string size;  ///< the option --size, for all commands that render or place records for pictures
  Graph graph = {};
  std::map<std::string, std::string> names = {};  ///< results of once(), by key

  const PlannedSegment& segment(int frame) const { return plan.segment_of(frame); }
  const Decisions& decided(int frame) const { return segment(frame).decisions; }
  const PlannedFrame& state(int frame) const { return segment(frame).at(frame); }
  int clamped(int frame) const;  ///< the closest frame of the animation
  bool preview() const { return wish.method == FrameMethod::preview; }

  /// The beginning of a command that depends on the light of a frame.
  Command at(int frame) const;
  /// Hash of the cameras of these frames.
  std::string cameras(const std::vector<int>& frames) const;
  /// Adds a file unless it is there already; returns its name. `frames`: the first part of its name.
  std::string add(const StageInfo& stage, const std::string& frames, const Command& command,
                  const std::vector<std::string>& beside_extensions = {});
  std::string add(const StageInfo& stage, int frame, const Command& command,
                  const std::vector<std::string>& beside_extensions = {});
  std::string add_state(const char* concern, int first, const std::string& content);
  /// The name that `make` returns. `make` is called only the first time that a key comes up.
  std::string once(const std::string& key, const std::function<std::string()>& make);
};

// Options are words separated by blanks, channels names separated by commas.
bool has_word(const std::string& words, const std::string& word);
bool has_channel(const std::string& channels, const std::string& name);
/// Adds the channels of `more` that are missing.
std::string with_channels(std::string channels, const std::string& more);
/// The frames as text: "3,4,7".
std::string joined(const std::vector<int>& frames);

// light_files.cpp; `lit` is the first frame of a state of light.
/// Adds options that name the files with the frame's light.
void add_light(GraphBuilder& g, int frame, Command& command);
/// The photon map of a state of light: the global map, or the dynamic map.
std::string photon_map(GraphBuilder& g, int lit);
/// The map from which smoke is computed: with --refine it has further paths where light in the smoke is noisy. Updates
/// continue from the map without them.
std::string refined_photon_map(GraphBuilder& g, int lit);
std::string point_file(GraphBuilder& g, int lit);

// picture_files.cpp
/// The picture that a frame shows, with smoke.
std::string picture_file(GraphBuilder& g, int frame);
/// A frame with the halves of its samples, filtered alone or with its neighbours. The window ends at the animation's
/// ends.
std::string filtered_picture(GraphBuilder& g, int frame, const std::string& channels);
/// Channels of a raw frame from which these filtered channels are made. A window of several frames needs the motion
/// between them.
std::string raw_channels(const Wish& wish, const std::string& filtered);
/// The options of a frame's pixels.
std::string pixels_of(const GraphBuilder& g, int frame);
Command frame_command(GraphBuilder& g, int frame, const std::string& pixels, const std::string& channels);
/// A hash of the positions and cameras in a frame and its neighbours if `channels` has motion; else "".
std::string in_motion(const GraphBuilder& g, int frame, const std::string& channels);
/// The first frame of the segment with the same picture; with the channel motion its neighbours must be the same, too.
/// At the ends of the segment only the frame itself qualifies, whatever frames are asked for.
int shown_by(const GraphBuilder& g, int frame, const std::string& channels);

// walk_files.cpp
/// A picture of a walkthrough: a key, or warped from the keys around it.
std::string walked_picture(GraphBuilder& g, int frame);

}  // namespace tempolux
