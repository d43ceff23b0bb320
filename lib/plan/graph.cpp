// lib/plan/graph.cpp -- turns decisions into files, stage by stage.
#include "lib/plan/graph.h"

#include <algorithm>
#include <array>
#include <cstdio>
#include <iomanip>
#include <iterator>
#include <set>
#include <sstream>

#include "formats/error.h"
#include "formats/hash.h"

namespace tempolux {
namespace {

using Names = std::vector<std::string>;

constexpr const char* kAudit =
    "--audit 0.02";  ///< share of the frame's rays; with the audit's look-ups less than 3 % of a run

std::string joined(const std::vector<int>& frames) {
  std::string text;
  for (const int frame : frames) text += (text.empty() ? "" : ",") + std::to_string(frame);
  return text;
}

bool has_word(const std::string& words, const std::string& word) {
  std::istringstream stream(words);
  using Words = std::istream_iterator<std::string>;
  return std::find(Words(stream), Words(), word) != Words();
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

/// Channels of a raw frame from which these filtered channels are made. A window of several frames needs the motion
/// between them.
std::string raw_channels(const Wish& wish, const std::string& filtered) {
  return with_channels(
      std::string("RGBA,layers,Z,N,id,albedo,coverage,halves,seen") + (wish.filter > 1 ? ",motion" : ""), filtered);
}

/// The options of a command, and the files among them.
struct Command {
  std::string words;
  Names inputs;
  std::string content;  ///< hashes of the scene's states that it depends on

  void option(const std::string& text) {
    if (!text.empty()) words += (words.empty() ? "" : " ") + text;
  }
  void file(const std::string& option_name, const std::string& name) {
    if (name.empty()) return;
    option(option_name.empty() ? name : option_name + " " + name);
    inputs.push_back(name);
  }
};

/// An interval of a walkthrough: the frames between two keys, all with the same light.
struct Interval {
  int first = 0, last = 0;
  int middle() const { return first + (last - first) / 2; }
};

class Builder {
 public:
  Builder(const Plan& plan, const Wish& wish, const ToolHash& tool_hash, const MajorantsText& majorants)
      : plan_(plan), wish_(wish), tool_hash_(tool_hash), majorants_(majorants) {
    size_ = "--size " + std::to_string(wish.width) + "x" + std::to_string(wish.height);
    preview_ = wish.method == FrameMethod::preview;
  }

  Graph build() {
    for (const int frame : plan_.frames) graph_.pictures[frame] = picture(plan_.shows.at(frame));
    for (const int frame : wish_.report) add_report(frame);
    remove_when_read();
    return std::move(graph_);
  }

 private:
  /// A raw picture is large, so the command that reads it removes it. A picture that two commands read stays, since
  /// either may run first.
  void remove_when_read() {
    std::map<std::string, int> readers;
    for (const GraphFile& file : graph_.files)
      for (const std::string& input : file.inputs) ++readers[input];
    for (GraphFile& file : graph_.files)
      file.passing = wish_.filter == 1 && file.stage == stage::raw.name && readers[file.name] == 1;
  }

  const PlannedSegment& segment(int frame) const { return plan_.segment_of(frame); }
  const Decisions& decided(int frame) const { return segment(frame).decisions; }
  const PlannedFrame& state(int frame) const { return segment(frame).at(frame); }
  int clamped(int frame) const { return std::clamp(frame, 0, plan_.last_frame); }

  /// Adds a file unless it is there already; returns its name.
  std::string add(const StageInfo& stage, const std::string& frames, const Command& command,
                  const Names& beside_extensions = {}) {
    Hasher hasher;
    for (const std::string& part :
         {std::string(stage.name), tool_hash_(std::string(stage.tool)), command.words, command.content, wish_.common})
      hasher.add(std::string_view(part));
    const std::string stem = std::string(stage.folder) + "/" + frames + "-" + key_of(hasher.hex());
    GraphFile file{
        stem + std::string(stage.extension), {}, std::string(stage.name), command.words, false, command.inputs};
    for (const std::string& extension : beside_extensions) file.beside.push_back(stem + extension);
    if (!graph_.find(file.name)) graph_.add(file);
    return file.name;
  }
  std::string add(const StageInfo& stage, int frame, const Command& command, const Names& beside_extensions = {}) {
    return add(stage, frame_digits(frame), command, beside_extensions);
  }
  std::string add_state(const char* concern, int first, const std::string& content) {
    const std::string name = "state/" + frame_digits(first) + "-" + key_of(hash_hex(content)) + "." + concern;
    if (std::ranges::find(graph_.states, name, &PlanFile::name) == graph_.states.end())
      graph_.states.push_back({name, content});
    return name;
  }

  void add_view(int frame, Command& c) {
    const PlannedSegment& s = segment(frame);
    if (s.decisions.view.empty()) c.option("--importance none");
    else c.file("--importance", add_state("view", s.first, s.decisions.view));
  }
  std::string majorants_file(int frame) {
    const PlannedSegment& s = segment(frame);
    if (!majorants_known_.contains(s.first))
      majorants_known_[s.first] = add_state("majorants", s.first, majorants_(s.first, s.last));
    return majorants_known_.at(s.first);
  }

  // ---- light ----------------------------------------------------------------------------------------------------
  std::string photon_words(int frame) const {
    const Decisions& d = decided(frame);
    return "--photons " + std::to_string(d.photon_paths) + " --kinds " + d.kinds;
  }
  bool moved(int frame) const { return decided(frame).moving != MovingMethod::anew; }
  /// Hash of all that a static map, its points and its records depend on.
  std::string standing_content(int frame) const {
    Hasher hasher;
    const PlannedSegment& s = segment(frame);
    for (const std::string& hash : {s.static_geometry, s.standing, s.frozen}) hasher.add(std::string_view(hash));
    for (const PlannedFrame& f : s.frames)
      hasher.add(std::string_view(f.light));  // movers of any frame decide which paths are touched
    return hasher.hex();
  }

  std::string stands_photons(int frame) {
    const int first = segment(frame).first;
    Command c{"--frame " + std::to_string(first) + " --map static", {}, standing_content(frame)};
    add_view(frame, c);
    c.option(photon_words(frame));
    return add(stage::stands_photons, first, c, {".paths"});
  }

  /// The photon map of a state of light: the global map, or the dynamic map.
  std::string photons(int lit) {
    if (moved(lit)) {
      Command c{"--frame " + std::to_string(lit) + " --map dynamic", {}, state(lit).light};
      c.file("--static", beside(stands_photons(lit), ".paths"));
      add_view(lit, c);
      return add(stage::moved_photons, lit, c);
    }
    Command c{"--frame " + std::to_string(lit), {}, state(lit).light};
    add_view(lit, c);
    c.option(photon_words(lit));
    if (plan_.media && !(wish_.update.empty() && wish_.refine.empty())) c.file("--majorants", majorants_file(lit));
    if (plan_.media && !wish_.update.empty()) add_update(lit, c);
    return add(stage::photons, lit, c);
  }
  /// In smoke, a map is the previous map of its segment with some groups traced again.
  void add_update(int lit, Command& c) {
    const std::vector<int> states = segment(lit).states();
    const auto here = std::ranges::find(states, lit);
    const bool by_pilots = std::ranges::count(std::array{"fde", "dip", "hybrid", "path"}, wish_.strategy) > 0;
    if (here == states.begin()) return c.option(by_pilots ? "--pilots 3%" : "");
    c.file("--update", photons(*std::prev(here)));
    c.option("--share " + wish_.update + " --strategy " + wish_.strategy);
  }

  /// The map from which smoke is computed: with --refine it has further paths where light in the smoke is noisy.
  /// Updates continue from the map without them.
  std::string refined_photons(int lit) {
    if (wish_.refine.empty()) return photons(lit);
    Command c{"--frame " + std::to_string(lit), {}, state(lit).light};
    c.file("--majorants", majorants_file(lit));
    c.file("--update", photons(lit));
    c.option("--refine " +
             std::to_string(std::uint64_t(std::stod(wish_.refine) / 100 * double(decided(lit).photon_paths))));
    add_view(lit, c);
    c.option("--kinds " + decided(lit).kinds);
    return add(stage::refined, lit, c);
  }

  std::string stands_points(int frame) {
    const int first = segment(frame).first;
    Command c{"--frame " + std::to_string(first) + " --map static", {}, standing_content(frame)};
    c.file("--photons", stands_photons(frame));
    add_view(frame, c);
    c.option(wish_.points);
    return add(stage::stands_points, first, c);
  }
  std::string points(int lit) {
    Command c{"--frame " + std::to_string(lit), {}, state(lit).light};
    if (moved(lit)) {
      c.file("--update", stands_points(lit));
      c.file("--photons", stands_photons(lit));
      c.file("--dynamic", photons(lit));
    } else {
      c.file("--photons", photons(lit));
    }
    add_view(lit, c);
    c.option(wish_.points);
    return add(stage::points, lit, c);
  }
  std::string low_points(int lit) {
    Command c;
    c.file("", points(lit));
    return add(stage::split, lit, c, {".high.irradpoints"});
  }
  /// Adds points as options: all points, or the low and the high part.
  void add_points(int lit, Command& c) {
    if (!decided(lit).split) return c.file("--points", points(lit));
    const std::string low = low_points(lit);
    c.file("--points", low);
    c.file("--high", beside(low, ".high.irradpoints"));
  }

  // ---- records --------------------------------------------------------------------------------------------------
  std::string record_words(int lit) const {
    const std::string rays =
        has_word(wish_.records, "--rays") ? "" : " --rays " + std::to_string(decided(lit).record_rays);
    return size_ + rays + (wish_.records.empty() ? "" : " " + wish_.records);
  }
  /// Hash of the cameras of these frames.
  std::string cameras(const std::vector<int>& frames) const {
    Hasher hasher;
    hasher.add(std::string_view(wish_.camera));
    for (const int frame : frames) hasher.add(std::string_view(state(frame).camera));
    return hasher.hex();
  }
  /// Pictures of the segment whose cameras share static records with a frame: a block of Decisions::together.
  std::vector<int> together(int frame) const {
    const std::vector<int> pictures = segment(frame).pictures();
    const auto size = std::ptrdiff_t(decided(frame).together);
    const auto block = (std::ranges::lower_bound(pictures, state(frame).picture) - pictures.begin()) / size;
    return {pictures.begin() + block * size,
            pictures.begin() + std::min(std::ptrdiff_t(pictures.size()), (block + 1) * size)};
  }
  std::string stands_records(int frame) {
    const std::vector<int> pictures = together(frame);
    Command c{"--frames " + joined(pictures) + " --map static", {}, standing_content(frame) + cameras(pictures)};
    c.file("--points", stands_points(frame));
    c.option(record_words(frame));
    return add(stage::stands_records, pictures.front(), c);
  }
  /// The state of light of the frame before, if this state's records continue that state's.
  int state_before(int lit) const { return lit > segment(lit).first ? state(lit - 1).lit_frame : lit; }
  /// True if records are kept over time. Only for states that a single picture shows: if the camera moves while the
  /// light is constant, one cache serves all its pictures.
  bool over_time(int lit) const {
    return decided(lit).moving == MovingMethod::time && segment(lit).pictures(lit).size() == 1;
  }

  std::string records(int frame) {
    const int picture = state(frame).picture;
    if (const auto found = records_.find(picture); found != records_.end()) return found->second;
    const int lit = state(frame).lit_frame;
    std::vector<int> pictures = together(frame);
    std::erase_if(pictures, [&](int other) { return state(other).lit_frame != lit; });
    std::string name;
    if (over_time(lit)) name = kept_records(lit);
    else if (decided(lit).moving == MovingMethod::records) name = updated_records(lit, pictures);
    else name = placed_records(lit, pictures);
    return records_[picture] = name;
  }
  std::string placed_records(int lit, const std::vector<int>& pictures) {
    Command c{"--frames " + joined(pictures), {}, state(lit).light + cameras(pictures)};
    add_points(lit, c);
    c.option(record_words(lit));
    return add(stage::records, pictures.front(), c);
  }
  std::string updated_records(int lit, const std::vector<int>& pictures) {
    Command c{"--frames " + joined(pictures), {}, state(lit).light + cameras(pictures)};
    c.file("--update", stands_records(pictures.front()));
    c.file("--points", points(lit));
    // Dynamic photons of up to two states before: records they affected are gathered again.
    std::vector<int> states{lit};
    for (int frame = lit; states.size() < 3 && frame > segment(lit).first;) {
      frame = state_before(frame);
      if (std::ranges::find(states, frame) != states.end()) break;
      states.push_back(frame);
    }
    for (const int frame : states) c.file("--dynamic", photons(frame));
    c.option(record_words(lit));
    return add(stage::records, pictures.front(), c);
  }
  std::string kept_records(int lit) {
    const PlannedSegment& s = segment(lit);  // samples store its borders
    Command c{
        "--frame " + std::to_string(lit), {}, state(lit).light + cameras(s.pictures(lit)) + joined({s.first, s.last})};
    add_points(lit, c);
    const int before = state_before(lit);
    if (before < lit && over_time(before)) c.file("--previous", beside(records(before), ".radsamples"));
    c.option(record_words(lit));
    return add(stage::kept, lit, c, {".radsamples"});
  }

  std::string textures(int lit) {
    Command c{"--frame " + std::to_string(lit), {}, state(lit).light};
    c.file("--photons", photons(lit));
    c.option(wish_.texture_words);
    return add(stage::textures, lit, c);
  }

  // ---- previews -------------------------------------------------------------------------------------------------
  static constexpr int kReach = kPreviewWindow / 2;
  /// Photons of a frame: a map of its own even if other frames have the same light, so that windows collect different
  /// photons. A segment with one state of light has as many maps as a window.
  std::string preview_photons(int frame, bool still) {
    const Decisions& d = decided(frame);
    Command c{"--frame " + std::to_string(frame) + (still ? "" : " --seed-mode frame"), {}, state(frame).light};
    add_view(frame, c);
    c.option("--photons " + std::to_string(d.photon_paths * (still ? kPreviewWindow : 1)) + " --kinds " + d.kinds);
    return add(stage::photons, frame, c);
  }
  std::string width_words(int frame) const {
    std::ostringstream words;
    words << "--filter-width " << decided(frame).texture_width;
    return words.str();
  }
  std::string counts(int frame) {
    const PlannedSegment& s = segment(frame);
    Command c{
        "--frame " + std::to_string(frame) + " --counts --kinds " + decided(frame).kinds + " " + width_words(frame),
        {},
        ""};
    // Sizes of moving elements depend on these frames, and jumps are detected from the neighbouring frames.
    for (const int f : {s.first, s.first + (s.last - s.first) / 2, s.last, frame - 2, frame - 1, frame, frame + 1})
      c.content += state(std::clamp(f, s.first, s.last)).light;
    c.file("--photons", preview_photons(frame, false));
    return add(stage::counts, frame, c);
  }
  /// The light textures of a state of light.
  std::string preview_light(int lit) {
    const PlannedSegment& s = segment(lit);
    Command c{"--frame " + std::to_string(lit), {}, state(lit).light};
    if (s.states().size() == 1) {
      c.option("--kinds " + s.decisions.kinds + " " + width_words(lit));
      c.file("--photons", preview_photons(lit, true));
      return add(stage::textures, lit, c);
    }
    c.option(width_words(lit) + " --counts");
    for (int f = std::max(s.first, lit - kReach); f <= std::min(s.last, lit + kReach); ++f) c.file("", counts(f));
    return add(stage::windows, lit, c);
  }

  // ---- pixels ---------------------------------------------------------------------------------------------------
  /// What lights a frame.
  void add_light(int frame, Command& c) {
    const Decisions& d = decided(frame);
    const int lit = state(frame).lit_frame;
    c.content += state(frame).light;
    if (preview_ && d.photons()) {
      c.file("--meshirrad", preview_light(lit));
    } else if (plan_.media && wish_.textures && d.photons()) {
      c.file("--meshirrad", textures(lit));
    } else if (d.points()) {
      if (d.records()) {
        c.file("--irradcache", records(frame));
        c.file("--points", points(lit));
      } else {
        add_points(lit, c);
      }
    }
    if (d.caustic_map && !preview_) {
      if (moved(lit)) c.file("--photons", stands_photons(lit));
      c.file(moved(lit) ? "--dynamic" : "--photons", photons(lit));
    }
  }
  /// Words for the pixels of a frame.
  std::string pixels_of(int frame) const {
    if (!wish_.preset_pixels) return wish_.pixels;
    std::ostringstream words;
    words << wish_.pixels << " --pixel-error " << std::setprecision(2) << decided(frame).pixel_error;
    return words.str();
  }
  Command frame_command(int frame, const std::string& pixels, const std::string& channels) {
    Command c{"--frame " + std::to_string(frame), {}, cameras({frame}) + in_motion(frame, channels)};
    add_light(frame, c);
    for (const std::string& words : {size_, pixels, "--channels " + channels}) c.option(words);
    if (decided(frame).photons() && !preview_) c.option(kAudit);
    return c;
  }
  /// With the channel motion, a hash of the positions and cameras in a frame and its neighbours.
  std::string in_motion(int frame, const std::string& channels) const {
    if (!has_channel(channels, "motion")) return "";
    Hasher hasher;
    for (const int f : {clamped(frame - 1), frame, clamped(frame + 1)})
      for (const std::string& hash : {state(f).light, state(f).camera}) hasher.add(std::string_view(hash));
    return hasher.hex();
  }
  /// The first frame of the segment with the same picture; with the channel motion its neighbours must be the same,
  /// too. At the ends of the segment only the frame itself qualifies, whatever frames are asked for.
  int shown(int frame, const std::string& channels) const {
    if (!has_channel(channels, "motion")) return state(frame).picture;
    for (int f = segment(frame).first + 1; f < frame; ++f)
      if (state(f).picture == state(frame).picture && in_motion(f, channels) == in_motion(frame, channels)) return f;
    return frame;
  }

  /// The picture that a frame shows, with smoke.
  std::string picture(int frame) {
    frame = shown(frame, wish_.channels);
    const std::string clear = clear_picture(frame);
    if (!plan_.media) return clear;
    const int lit = state(frame).lit_frame;
    Command c{"--frame " + std::to_string(frame), {}, state(frame).light + cameras({frame})};
    c.file("--base", clear);
    c.file("--photons", refined_photons(lit));
    if (!wish_.textures && decided(frame).points()) c.file("--points", points(lit));
    c.option(wish_.smoke_words);
    return add(stage::smoke, frame, c);
  }
  std::string clear_picture(int frame) {
    const bool walk =
        !plan_.media && (wish_.method == FrameMethod::walkthrough ||
                         (wish_.method == FrameMethod::automatic && decided(frame).walk && wish_.filter <= 1));
    if (walk) return walked_picture(frame);
    if (wish_.filter > 0) return filtered_picture(frame, wish_.channels);
    return add(stage::pictures, frame, frame_command(frame, pixels_of(frame), wish_.channels));
  }

  /// A frame with the halves of its samples, filtered alone or with its neighbours. The window ends at the animation's
  /// ends.
  std::string filtered_picture(int frame, const std::string& channels) {
    // The frames of a window need independent noise.
    const std::string pixels =
        pixels_of(frame) + (wish_.filter > 1 ? " --seed-mode frame" : "") + " --compression none";
    const std::string raw_names = raw_channels(wish_, channels);
    Command c;
    std::size_t position = 0;
    for (int f = frame - wish_.filter / 2; f <= frame + wish_.filter / 2; ++f) {
      if (f != clamped(f)) continue;
      const int like = shown(f, raw_names);
      const std::string raw = add(stage::raw, like, frame_command(like, pixels, raw_names));
      if (c.inputs.empty() || c.inputs.back() != raw) c.file("", raw);
      if (f == frame) position = c.inputs.size();
    }
    c.option("--position " + std::to_string(position) + " --channels " + channels);
    return add(stage::filtered, frame, c);
  }

  // ---- walkthrough ----------------------------------------------------------------------------------------------
  /// Keys and what lies between them show the same light, so that no light is carried into a frame that does not have
  /// it.
  bool same_light(const Interval& interval) const {
    for (int f = interval.first; f <= interval.last; ++f)
      if (state(f).light != state(interval.first).light) return false;
    return true;
  }
  std::string key_picture(int frame) {
    const bool layers = wish_.filter > 0 || has_channel(wish_.channels, "layers");
    const std::string channels = with_channels(wish_.channels, layers ? "Z,N,id,layers" : "Z,N,id,specular");
    frame = shown(frame, channels);
    if (wish_.filter > 0) return filtered_picture(frame, channels);
    return add(stage::keys, frame, frame_command(frame, pixels_of(frame), channels));
  }
  /// The interval of equal light between first keys that strictly holds a frame; false: the frame is a key. Intervals
  /// start at fixed multiples; an interval whose light changes is halved until it does not.
  bool interval_around(int frame, Interval& interval) const {
    const int first = frame - frame % wish_.key_distance;
    interval = {first, clamped(first + wish_.key_distance)};
    while (frame > interval.first && frame < interval.last) {
      if (same_light(interval)) return true;
      (frame < interval.middle() ? interval.last : interval.first) = interval.middle();
    }
    return false;
  }
  std::string interval_name(const Interval& i) const { return frame_digits(i.first) + "+" + frame_digits(i.last); }

  /// The file that decides an interval, from its keys and from the files of its halves.
  std::string interval_file(const Interval& i) {
    if (i.last - i.first < 2) return "";
    if (const auto found = intervals_.find(i.first * 1'000'000LL + i.last); found != intervals_.end())
      return found->second;
    const std::string left = interval_file({i.first, i.middle()}), right = interval_file({i.middle(), i.last});
    Command c;
    c.file("", key_picture(i.first));
    c.file("", key_picture(i.last));
    std::ostringstream threshold;
    threshold << wish_.threshold;
    for (const std::string& word : {frame_digits(i.middle()), key_picture(i.middle()), threshold.str(),
                                    left.empty() ? "-" : left, right.empty() ? "-" : right})
      c.option(word);
    c.content = tool_hash_("aqm-compare") + cameras({i.middle()});
    const std::string name = add(stage::walk, interval_name(i), c);
    intervals_[i.first * 1'000'000LL + i.last] = name;
    return name;
  }
  std::string walked_picture(int frame) {
    Interval interval;
    if (!interval_around(frame, interval)) return key_picture(frame);
    const std::string decided_by = interval_file(interval);
    if (std::ranges::find(graph_.intervals, decided_by) == graph_.intervals.end())
      graph_.intervals.push_back(decided_by);
    Command light{"", {}, ""};
    add_light(frame, light);
    Command c{"",
              {},
              tool_hash_("ibr-warp") + (wish_.filter > 0 ? tool_hash_("st-filter") : "") + light.content +
                  cameras({frame}) + in_motion(frame, wish_.channels)};
    c.file("", decided_by);
    c.option(frame_digits(frame));
    c.option(wish_.filter > 0 ? wish_.channels : "-");
    for (const std::string& words :
         {light.words, size_, pixels_of(frame),
          "--channels " + (wish_.filter > 0 ? raw_channels(wish_, wish_.channels) : wish_.channels)})
      c.option(words);
    c.inputs.insert(c.inputs.end(), light.inputs.begin(), light.inputs.end());
    return add(stage::walked, frame, c);
  }

  // ---- report ---------------------------------------------------------------------------------------------------
  void add_report(int frame) {
    const int shown = state(plan_.shows.at(frame)).picture;
    const std::string picture_name = picture(plan_.shows.at(frame));
    Command path{"--frame " + std::to_string(shown) + " --integrator path --halves " + size_ + " --spp " +
                     std::to_string(wish_.reference_samples) + " --channels RGBA",
                 {},
                 state(shown).light + cameras({shown})};
    const std::string reference = add(stage::reference, shown, path, {"_a.exr", "_b.exr"});
    Command compare;
    compare.file("", picture_name);
    compare.inputs.push_back(reference);
    compare.option("--reference-halves " + beside(reference, "_a.exr") + " " + beside(reference, "_b.exr"));
    graph_.errors[frame] = add(stage::error, shown, compare);
    std::set<std::string> seen;
    collect_stats(picture_name, seen, graph_.spent[graph_.errors[frame]]);
  }
  void collect_stats(const std::string& name, std::set<std::string>& seen, Names& stats) const {
    const GraphFile* found = graph_.find(name);
    if (!found || !seen.insert("made " + found->name).second) return;
    for (const std::string& input : found->inputs) collect_stats(input, seen, stats);
    stats.push_back(beside(found->name, ".json"));
  }

  const Plan& plan_;
  const Wish& wish_;
  const ToolHash& tool_hash_;
  const MajorantsText& majorants_;
  std::string size_;
  bool preview_ = false;
  Graph graph_;
  std::map<int, std::string> majorants_known_, records_;
  std::map<long long, std::string> intervals_;
};

}  // namespace

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

std::string frame_digits(int frame) {
  std::array<char, 16> text{};
  std::snprintf(text.data(), text.size(), "%04d", frame);
  return text.data();
}

std::vector<int> helper_frames(const std::vector<int>& frames, const Wish& wish) {
  std::set<int> helpers;
  const int beside = has_channel(raw_channels(wish, wish.channels), "motion");
  const auto add = [&](int first, int last) {
    for (int f = first - beside; f <= last + beside; ++f) helpers.insert(f);
  };
  for (const int frame : frames) {
    add(frame - wish.filter / 2, frame + wish.filter / 2);
    const int first = frame - frame % wish.key_distance;
    if (wish.method != FrameMethod::frames && wish.method != FrameMethod::preview)
      add(first, first + wish.key_distance);
  }
  return {helpers.begin(), helpers.end()};
}

Graph make_graph(const Plan& plan, const Wish& wish, const ToolHash& tool_hash, const MajorantsText& majorants) {
  if (plan.media && wish.method == FrameMethod::walkthrough)
    throw InputError(
        "METHOD=walkthrough: the scene has media, which warping between keys does not know; use METHOD=frames");
  if (plan.media && wish.method == FrameMethod::preview)
    throw InputError(
        "METHOD=preview: the scene has media, which light textures leave out; use METHOD=frames SURFACES=textures");
  if (!plan.media && !(wish.update.empty() && wish.refine.empty()))
    throw InputError("UPDATE and REFINE are for maps of scenes with media; this scene has none");
  if (wish.filter > 1 && wish.method == FrameMethod::walkthrough)
    throw InputError("FILTER=" + std::to_string(wish.filter) +
                     " with METHOD=walkthrough: what is warped has its keys' noise in all frames, so that "
                     "frames around it know nothing more; use FILTER=1");
  return Builder(plan, wish, tool_hash, majorants).build();
}

}  // namespace tempolux
