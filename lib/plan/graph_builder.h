// lib/plan/graph_builder.h -- builds a graph. Each function adds one file and the files that it is made from, so the
// graph holds what the pictures need and nothing else.
#pragma once

#include <functional>
#include <map>
#include <string>
#include <vector>

#include "lib/plan/graph.h"

namespace tempolux {

/// A command: its options, its input files, and everything else that its result depends on.
struct Command {
  std::string words;
  std::vector<std::string> inputs;
  std::string content;           ///< hashes of the scene's states that the result depends on
  std::string state_words = {};  ///< options that name files of state/; only the content of these files enters the key

  void option(const std::string& text) {
    if (!text.empty()) words += (words.empty() ? "" : " ") + text;
  }
  void file(const std::string& option_name, const std::string& name) {
    if (name.empty()) return;
    option(option_name.empty() ? name : option_name + " " + name);
    inputs.push_back(name);
  }
  /// Adds the options, inputs and content of another command. Its options begin with `begin` in place of "--".
  void append(const Command& other, const std::string& begin = "--");
  /// Adds a file of state/. The part of its name before '-' is the first frame of the segment. The result does not
  /// depend on this part, so the key does not either.
  void state_file(const std::string& option_name, const std::string& name) {
    state_words += " " + option_name + " " + name;
    content += name.substr(name.find('-'));
    inputs.push_back(name);
  }
};

/// A graph under construction, and what it is made from.
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
  /// The same without lens and shutter, for what does not depend on them.
  std::string pinholes(const std::vector<int>& frames) const;
  /// Adds a file unless it is there already; returns its name. `frames`: the first part of its name.
  std::string add(const StageInfo& stage, const std::string& frames, const Command& command);
  std::string add(const StageInfo& stage, int frame, const Command& command);
  /// Adds a file of state/ unless it is there already; returns its name. `concern` is its extension, `first` the first
  /// frame of its segment.
  std::string add_state(const char* concern, int first, const std::string& content);
  /// Returns the name that `make` returns for this key. Calls `make` only the first time that a key is asked for.
  std::string once(const std::string& key, const std::function<std::string()>& make);

 private:
  std::string hash_of(std::string PlannedFrame::*member, const std::vector<int>& frames) const;
};

/// True if the options, which are separated by blanks, contain the word; if the channels, which are separated by
/// commas, contain the name.
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
/// The map that lights smoke. With the wish `refine` this map has further paths where light in smoke is noisy; the maps
/// of later states are updated from the map without these paths.
std::string refined_photon_map(GraphBuilder& g, int lit);
/// The irradiance points of a state of light.
std::string point_file(GraphBuilder& g, int lit);

// picture_files.cpp
/// The picture that a frame shows, with smoke.
std::string picture_file(GraphBuilder& g, int frame);
/// A filtered frame: rendered with the halves of its samples, then filtered alone or with its neighbours. The filter's
/// window is cut off at the ends of the animation.
std::string filtered_picture(GraphBuilder& g, int frame, const std::string& channels);
/// The channels that a raw frame needs so that the filter can make the channels `filtered`. A window of several frames
/// also needs the motion between frames.
std::string raw_channels(const Wish& wish, const std::string& filtered);
/// The options of a frame's pixels.
std::string pixels_of(const GraphBuilder& g, int frame);
/// The command that renders a frame with these options of its pixels and these channels.
Command frame_command(GraphBuilder& g, int frame, const std::string& pixels, const std::string& channels);
/// What a frame's data channels depend on: a hash of the positions and cameras in the frame and its neighbours if
/// `channels` has motion, and a hash of the names of objects and materials if `channels` has mattes; else "".
std::string in_data(const GraphBuilder& g, int frame, const std::string& channels);
/// The frame whose picture this frame shows: the first frame of the segment with the same picture. If `channels` has
/// motion, the neighbours of both frames must be the same, too, and the segment's first frame serves only itself,
/// because its previous frame lies in another segment.
int shown_by(const GraphBuilder& g, int frame, const std::string& channels);

// walk_files.cpp
/// A picture of a walkthrough: a key, or warped from the keys around it.
std::string walked_picture(GraphBuilder& g, int frame);

}  // namespace tempolux
