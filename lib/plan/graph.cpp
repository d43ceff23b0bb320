// lib/plan/graph.cpp -- turns decisions into files: the files of the pictures asked for, and those of the report.
#include "lib/plan/graph.h"

#include <algorithm>
#include <iterator>
#include <set>
#include <sstream>

#include "formats/error.h"
#include "formats/hash.h"
#include "lib/core/formatted.h"
#include "lib/plan/graph_builder.h"

namespace tempolux {
namespace {

/// Statistics of all commands that lead to a file, each once.
void collect_stats(const GraphBuilder& g, const std::string& name, std::set<std::string>& seen,
                   std::vector<std::string>& stats) {
  const GraphFile* found = g.graph.find(name);
  if (!found || !seen.insert("made " + found->name).second) return;
  for (const std::string& input : found->inputs) collect_stats(g, input, seen, stats);
  stats.push_back(beside(found->name, ".json"));
}

void add_report(GraphBuilder& g, int frame) {
  const int shown = g.state(g.plan.shows.at(frame)).picture;
  const std::string picture_name = picture_file(g, g.plan.shows.at(frame));
  Command path{"--frame " + std::to_string(shown) + " --integrator path --halves " + g.size + " --spp " +
                   std::to_string(g.wish.reference_samples) + " --channels RGBA",
               {},
               g.state(shown).light + g.cameras({shown})};
  const std::string reference = g.add(stage_in("path"), shown, path);
  Command compare;
  compare.file("", picture_name);
  compare.inputs.push_back(reference);
  compare.option("--reference-halves " + beside(reference, "_a.exr") + " " + beside(reference, "_b.exr"));
  g.graph.errors[frame] = g.add(stage_in("error"), shown, compare);
  std::set<std::string> seen;
  collect_stats(g, picture_name, seen, g.graph.spent[g.graph.errors[frame]]);
}

/// Number of the animation's frames whose windows hold this frame.
int windows_around(const GraphBuilder& g, int frame) {
  const int beside = g.wish.filter / 2;
  return g.clamped(frame + beside) - g.clamped(frame - beside) + 1;
}

/// A raw picture is large, so it is removed when all frames whose windows hold it are filtered. If the plan lacks some
/// of these frames, as at the ends of a range, the picture stays for them.
void remove_when_read(GraphBuilder& g) {
  std::map<std::string, int> readers;
  for (const GraphFile& file : g.graph.files)
    for (const std::string& input : file.inputs) ++readers[input];
  for (GraphFile& file : g.graph.files) {
    const std::string first_part = std::string(stage_in("raw").folder) + "/";
    if (!file.name.starts_with(first_part)) continue;
    file.passing = readers[file.name] == windows_around(g, std::stoi(file.name.substr(first_part.size())));
  }
}

}  // namespace

std::string joined(const std::vector<int>& frames) {
  std::string text;
  for (const int frame : frames) text += (text.empty() ? "" : ",") + std::to_string(frame);
  return text;
}

std::vector<std::string> words_of(std::string_view text) {
  std::istringstream stream{std::string(text)};
  using Words = std::istream_iterator<std::string>;
  return {Words(stream), Words()};
}

bool has_word(const std::string& words, const std::string& word) {
  const std::vector<std::string> all = words_of(words);
  return std::ranges::find(all, word) != all.end();
}

bool has_channel(const std::string& channels, const std::string& name) {
  return ("," + channels + ",").find("," + name + ",") != std::string::npos;
}

/// Adds the channels of `more` that are missing.
std::string with_channels(std::string channels, const std::string& more) {
  std::istringstream names(more);
  for (std::string name; std::getline(names, name, ',');)
    if (!has_channel(channels, name)) channels += "," + name;
  return channels;
}

void Command::append(const Command& other, const std::string& begin) {
  for (const std::string& word : words_of(other.words)) option(word.starts_with("--") ? begin + word.substr(2) : word);
  inputs.insert(inputs.end(), other.inputs.begin(), other.inputs.end());
  content += other.content;
}

int GraphBuilder::clamped(int frame) const { return std::clamp(frame, 0, plan.last_frame); }

Command GraphBuilder::at(int frame) const { return {"--frame " + std::to_string(frame), {}, state(frame).light}; }

std::string GraphBuilder::hash_of(std::string PlannedFrame::*member, const std::vector<int>& frames) const {
  Hasher hasher;
  hasher.add(wish.camera);
  for (const int frame : frames) hasher.add(std::string_view(state(frame).*member));
  return hasher.hex();
}

std::string GraphBuilder::cameras(const std::vector<int>& frames) const {
  return hash_of(&PlannedFrame::camera, frames);
}

std::string GraphBuilder::pinholes(const std::vector<int>& frames) const {
  return hash_of(&PlannedFrame::pinhole, frames);
}

std::string GraphBuilder::add(const StageInfo& stage, const std::string& frames, const Command& command) {
  const std::string key =
      key_of(hash_of_texts({stage.name, stage.command, stage.outputs, tool_hash(std::string(stage.tool())),
                            command.words, command.content, wish.common}));
  std::vector<std::string> made = words_of(stage.extensions);
  for (std::string& name : made) name.insert(0, std::string(stage.folder) + "/" + frames + "-" + key);
  const std::string first = made.front();
  made.erase(made.begin());
  if (!graph.find(first)) graph.add({first, made, &stage, command.words + command.state_words, false, command.inputs});
  return first;
}

std::string GraphBuilder::add(const StageInfo& stage, int frame, const Command& command) {
  return add(stage, frame_digits(frame), command);
}

std::string GraphBuilder::add_state(const char* concern, int first, const std::string& content) {
  const std::string name = "state/" + frame_digits(first) + "-" + key_of(hash_hex(content)) + "." + concern;
  if (std::ranges::find(graph.states, name, &PlanFile::name) == graph.states.end())
    graph.states.push_back({name, content});
  return name;
}

std::string GraphBuilder::once(const std::string& key, const std::function<std::string()>& make) {
  if (const auto found = names.find(key); found != names.end()) return found->second;
  return names[key] = make();
}

const GraphFile* Graph::find(const std::string& name) const {
  const auto found = by_name.find(name);
  return found == by_name.end() ? nullptr : &files[found->second];
}

void Graph::add(const GraphFile& file) {
  by_name[file.name] = files.size();
  for (const std::string& name : file.beside) by_name[name] = files.size();
  files.push_back(file);
}

std::string stem_of(const std::string& name) { return name.substr(0, name.find('.')); }
std::string beside(const std::string& name, const std::string& extension) { return stem_of(name) + extension; }
std::string key_of(const std::string& hash) { return hash.substr(0, 10); }

std::string frame_digits(int frame) { return formatted("%04d", frame); }

std::vector<int> helper_frames(const std::vector<int>& frames, const Wish& wish) {
  std::set<int> helpers;
  const int beside = has_channel(raw_channels(wish, wish.channels), "motion");
  const auto add = [&](int first, int last) {
    for (int f = first - beside; f <= last + beside; ++f) helpers.insert(f);
  };
  for (const int frame : frames) {
    add(frame - wish.filter / 2, frame + wish.filter / 2);
    const int first = frame - frame % wish.key_distance;
    if (wish.method == FrameMethod::walkthrough) add(first, first + wish.key_distance);
  }
  return {helpers.begin(), helpers.end()};
}

Graph make_graph(const Plan& plan, const Wish& wish, const ToolHash& tool_hash, const MajorantsText& majorants) {
  if (plan.media && wish.method == FrameMethod::walkthrough)
    throw InputError(
        "METHOD=walkthrough: the scene has media, which warping between keys does not know; use METHOD=frames");
  if (wish.method == FrameMethod::walkthrough && std::ranges::any_of(plan.segments, &PlannedSegment::is_blurred))
    throw InputError(
        "METHOD=walkthrough: the camera's lens or shutter blurs pictures, and warping moves sharp ones only; use "
        "METHOD=frames, or FSTOP=0 SHUTTER=0 for a sharp film");
  if (plan.media && wish.method == FrameMethod::preview)
    throw InputError("METHOD=preview: the scene has media, which light textures leave out; use METHOD=frames");
  if (!plan.media && !(wish.update.empty() && wish.refine.empty()))
    throw InputError("UPDATE and REFINE are for maps of scenes with media; this scene has none");
  if (wish.filter > 1 && wish.method == FrameMethod::walkthrough)
    throw InputError("FILTER=" + std::to_string(wish.filter) +
                     " with METHOD=walkthrough: what is warped has its keys' noise in all frames, so that "
                     "frames around it know nothing more; use FILTER=1");
  GraphBuilder g{plan, wish, tool_hash, majorants,
                 "--size " + std::to_string(wish.width) + "x" + std::to_string(wish.height)};
  for (const int frame : plan.frames) g.graph.pictures[frame] = picture_file(g, plan.shows.at(frame));
  for (const int frame : wish.report) add_report(g, frame);
  g.graph.exposure = wish.exposure;
  remove_when_read(g);
  return std::move(g.graph);
}

}  // namespace tempolux
