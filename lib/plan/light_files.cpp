// lib/plan/light_files.cpp -- the files that light frames: photons, irradiance points, records, light textures.
#include <algorithm>
#include <array>
#include <set>
#include <sstream>

#include "formats/hash.h"
#include "lib/plan/graph_builder.h"

namespace tempolux {
namespace {

/// Adds --importance: the segment's view file, by which photons are aimed and points spread, or none.
void add_view(GraphBuilder& g, int frame, Command& c) {
  const PlannedSegment& s = g.segment(frame);
  if (s.decisions.view.empty()) c.option("--importance none");
  else c.state_file("--importance", g.add_state("view", s.first, s.decisions.view));
}

std::string majorants_file(GraphBuilder& g, int frame) {
  const PlannedSegment& s = g.segment(frame);
  return g.once("majorants " + std::to_string(s.first),
                [&] { return g.add_state("majorants", s.first, g.majorants(s.first, s.last)); });
}

/// The options that decide which photons are traced: the number of light paths and the kinds.
std::string photon_words(const GraphBuilder& g, int frame) {
  const Decisions& d = g.decided(frame);
  return "--photons " + std::to_string(d.photon_paths) + " --kinds " + d.kinds;
}

/// True if the light of the frame is derived from the static light of its segment.
bool moved(const GraphBuilder& g, int frame) { return g.decided(frame).moving != MovingMethod::anew; }

/// Frame number in the names of static light: the same for all segments, so that segments with equal static scenes
/// share the files.
constexpr int kAnyFrame = 0;

/// A command that makes static light. Its key holds everything that the static scene depends on. The key leaves out the
/// frame number in the command, which differs between segments with the same static scene.
Command static_light(const GraphBuilder& g, int frame) {
  const PlannedSegment& s = g.segment(frame);
  return {"--map static", {}, hash_of_texts({s.static_scene, s.frozen}), " --frame " + std::to_string(s.first)};
}

std::string static_photons(GraphBuilder& g, int frame) {
  Command c = static_light(g, frame);
  add_view(g, frame, c);
  c.option(photon_words(g, frame));
  return g.add(stage_in("stands"), kAnyFrame, c);
}

/// The light paths of the static scene that the segment's movers touch.
std::string touched_paths(GraphBuilder& g, int frame) {
  const int first = g.segment(frame).first;
  Command c{"--frame " + std::to_string(first) + " --map static", {}, static_light(g, frame).content};
  for (const PlannedFrame& f : g.segment(frame).frames) c.content += f.light;
  add_view(g, frame, c);
  c.option(photon_words(g, frame));
  return g.add(stage_in("touched"), first, c);
}

/// Makes the command update the map of the previous state of light, of which it traces some groups again. The segment's
/// first map is traced whole, with pilots if the strategy needs them.
void add_update(GraphBuilder& g, int lit, Command& c) {
  const std::vector<int> states = g.segment(lit).states();
  const auto here = std::ranges::find(states, lit);
  const bool by_pilots = std::ranges::count(std::array{"fde", "dip", "hybrid", "path"}, g.wish.strategy) > 0;
  if (here == states.begin()) return c.option(by_pilots ? "--pilots 3%" : "");
  c.file("--update", photon_map(g, *std::prev(here)));
  c.option("--share " + g.wish.update + " --strategy " + g.wish.strategy);
}

std::string static_points(GraphBuilder& g, int frame) {
  Command c = static_light(g, frame);
  c.file("--photons", static_photons(g, frame));
  add_view(g, frame, c);
  c.option(g.wish.points);
  return g.add(stage_in("stands_points"), kAnyFrame, c);
}

/// Adds the options that name the points: all points, or the low and the high part.
void add_points(GraphBuilder& g, int lit, Command& c) {
  const std::string all = point_file(g, lit);
  if (!g.decided(lit).split) return c.file("--points", all);
  Command divide;
  divide.file("", all);
  const std::string low = g.add(stage_in("split"), lit, divide);
  c.file("--points", low);
  c.file("--high", beside(low, ".high.irradpoints"));
}

/// The options of the commands that gather records: picture size, gather rays and the options of the wish.
std::string record_words(const GraphBuilder& g, int record_rays) {
  const std::string rays = has_word(g.wish.records, "--rays") ? "" : " --rays " + std::to_string(record_rays);
  return g.size + rays + (g.wish.records.empty() ? "" : " " + g.wish.records);
}

/// Pictures of the segment whose cameras share static records with a frame: a block of Decisions::together.
std::vector<int> together(const GraphBuilder& g, int frame) {
  const std::vector<int> pictures = g.segment(frame).views();
  const auto size = std::ptrdiff_t(g.decided(frame).together);
  const auto block = (std::ranges::lower_bound(pictures, g.state(frame).viewed) - pictures.begin()) / size;
  return {pictures.begin() + block * size,
          pictures.begin() + std::min(std::ptrdiff_t(pictures.size()), (block + 1) * size)};
}

/// Those of `pictures` whose pinhole cameras differ: the first of each.
std::vector<int> different_cameras(const GraphBuilder& g, const std::vector<int>& pictures) {
  std::set<std::string> seen;
  std::vector<int> different;
  for (const int picture : pictures)
    if (seen.insert(g.state(picture).pinhole).second) different.push_back(picture);
  return different;
}

/// The records of the static scene for the cameras of a block of pictures. As with other static light, the key leaves
/// out numbers of frames: while the camera stands, segments with equal static scenes share the file.
std::string static_records(GraphBuilder& g, int frame) {
  const std::vector<int> pictures = different_cameras(g, together(g, frame));
  Command c = static_light(g, frame);
  c.state_words = " --frames " + joined(pictures);
  c.content += g.pinholes(pictures);
  c.file("--points", static_points(g, frame));
  c.option(record_words(g, g.decided(frame).static_rays()));
  return g.add(stage_in("stands_cache"), pictures.size() == 1 ? kAnyFrame : pictures.front(), c);
}

/// The state of light of the previous frame; `lit` itself at the first frame of the segment.
int state_before(const GraphBuilder& g, int lit) {
  return lit > g.segment(lit).first ? g.state(lit - 1).lit_frame : lit;
}

/// True if records are kept over time. A state of light with several pictures (the camera moves while the light is
/// constant) has one cache for all of them instead.
bool over_time(const GraphBuilder& g, int lit) {
  return g.decided(lit).moving == MovingMethod::time && g.segment(lit).views(lit).size() == 1;
}

/// Records that are gathered for these pictures of one state of light, without static records.
std::string placed_records(GraphBuilder& g, int lit, const std::vector<int>& pictures) {
  Command c{"--frames " + joined(pictures), {}, g.state(lit).light + g.pinholes(pictures)};
  add_points(g, lit, c);
  c.option(record_words(g, g.decided(lit).record_rays));
  return g.add(stage_in("cache"), pictures.front(), c);
}

/// Static records updated for these pictures of one state of light, and records gathered where movers matter.
std::string updated_records(GraphBuilder& g, int lit, const std::vector<int>& pictures) {
  Command c{"--frames " + joined(pictures), {}, g.state(lit).light + g.pinholes(pictures)};
  c.file("--update", static_records(g, pictures.front()));
  c.file("--points", point_file(g, lit));
  // Records that movers affected in one of the two previous states are gathered again, too.
  std::vector<int> states{lit};
  for (int frame = lit; states.size() < 3 && frame > g.segment(lit).first;) {
    frame = state_before(g, frame);
    if (std::ranges::find(states, frame) != states.end()) break;
    states.push_back(frame);
  }
  for (const int frame : states) c.file("--dynamic", photon_map(g, frame));
  c.option(record_words(g, g.decided(lit).record_rays));
  return g.add(stage_in("cache"), pictures.front(), c);
}

std::string record_file(GraphBuilder& g, int frame);

/// Records of a state of light that follow from the records of the state before it in the segment.
std::string kept_records(GraphBuilder& g, int lit) {
  const PlannedSegment& s = g.segment(lit);  // the .radsamples file stores its borders
  Command c{
      "--frame " + std::to_string(lit), {}, g.state(lit).light + g.pinholes(s.views(lit)) + joined({s.first, s.last})};
  add_points(g, lit, c);
  const int before = state_before(g, lit);
  if (before < lit && over_time(g, before)) c.file("--previous", beside(record_file(g, before), ".radsamples"));
  c.option(record_words(g, g.decided(lit).record_rays));
  return g.add(stage_in("kept"), lit, c);
}

std::string record_file(GraphBuilder& g, int frame) {
  return g.once("records " + std::to_string(g.state(frame).viewed), [&] {
    const int lit = g.state(frame).lit_frame;
    if (over_time(g, lit)) return kept_records(g, lit);
    std::vector<int> pictures = together(g, frame);
    std::erase_if(pictures, [&](int other) { return g.state(other).lit_frame != lit; });
    return g.decided(lit).moving == MovingMethod::records ? updated_records(g, lit, pictures)
                                                          : placed_records(g, lit, pictures);
  });
}

constexpr int kReach = kPreviewWindow / 2;  ///< largest number of frames of a window on each side of its frame

/// The photon map of a frame of a preview. Each frame has its own map even if other frames have the same light, so
/// that windows collect different photons. A segment with one state of light has as many maps as a window has frames.
std::string preview_photons(GraphBuilder& g, int frame, bool still) {
  const Decisions& d = g.decided(frame);
  Command c{"--frame " + std::to_string(frame) + (still ? "" : " --seed-mode frame"), {}, g.state(frame).light};
  add_view(g, frame, c);
  c.option("--photons " + std::to_string(d.photon_paths * (still ? kPreviewWindow : 1)) + " --kinds " + d.kinds);
  return g.add(stage_in("photons"), frame, c);
}

std::string width_words(const GraphBuilder& g, int frame) {
  std::ostringstream words;
  words << "--filter-width " << g.decided(frame).texture_width;
  return words.str();
}

/// The photons of one frame of a preview, counted by element.
std::string counts(GraphBuilder& g, int frame) {
  const PlannedSegment& s = g.segment(frame);
  Command c{
      "--frame " + std::to_string(frame) + " --counts --kinds " + g.decided(frame).kinds + " " + width_words(g, frame),
      {},
      ""};
  // The sizes of moving elements depend on the first, middle and last frame; jumps of light on the neighbouring frames.
  for (const int f : {s.first, s.first + (s.last - s.first) / 2, s.last, frame - 2, frame - 1, frame, frame + 1})
    c.content += g.state(std::clamp(f, s.first, s.last)).light;
  c.file("--photons", preview_photons(g, frame, false));
  return g.add(stage_in("counts"), frame, c);
}

/// The light textures of a state of light.
std::string preview_light(GraphBuilder& g, int lit) {
  const PlannedSegment& s = g.segment(lit);
  Command c = g.at(lit);
  if (s.states().size() == 1) {
    c.option("--kinds " + s.decisions.kinds + " --reach 0 " + width_words(g, lit));
    c.file("--photons", preview_photons(g, lit, true));
    return g.add(stage_in("windows"), lit, c);
  }
  c.option(width_words(g, lit) + " --counts");
  for (int f = std::max(s.first, lit - kReach); f <= std::min(s.last, lit + kReach); ++f) c.file("", counts(g, f));
  return g.add(stage_in("windows"), lit, c);
}

}  // namespace

std::string photon_map(GraphBuilder& g, int lit) {
  if (moved(g, lit)) {
    // The .paths file lists the paths to trace for all frames of the segment. It is left out of the key: an edit of
    // another frame changes that file, but not this frame's map.
    Command c{"--frame " + std::to_string(lit) + " --map dynamic",
              {},
              g.state(lit).light + static_light(g, lit).content + photon_words(g, lit)};
    const std::string touched = touched_paths(g, lit);
    c.state_words = " --static " + touched;
    c.inputs.push_back(touched);
    add_view(g, lit, c);
    return g.add(stage_in("moved"), lit, c);
  }
  Command c = g.at(lit);
  add_view(g, lit, c);
  c.option(photon_words(g, lit));
  if (g.plan.media && !(g.wish.update.empty() && g.wish.refine.empty()))
    c.state_file("--majorants", majorants_file(g, lit));
  if (g.plan.media && !g.wish.update.empty()) add_update(g, lit, c);
  return g.add(stage_in("photons"), lit, c);
}

std::string refined_photon_map(GraphBuilder& g, int lit) {
  if (g.wish.refine.empty()) return photon_map(g, lit);
  Command c = g.at(lit);
  c.state_file("--majorants", majorants_file(g, lit));
  c.file("--update", photon_map(g, lit));
  c.option("--refine " +
           std::to_string(std::uint64_t(std::stod(g.wish.refine) / 100 * double(g.decided(lit).photon_paths))));
  add_view(g, lit, c);
  c.option("--kinds " + g.decided(lit).kinds);
  return g.add(stage_in("refined"), lit, c);
}

std::string point_file(GraphBuilder& g, int lit) {
  Command c = g.at(lit);
  if (moved(g, lit)) {
    c.file("--update", static_points(g, lit));
    c.file("--photons", static_photons(g, lit));
    c.file("--dynamic", photon_map(g, lit));
  } else {
    c.file("--photons", photon_map(g, lit));
  }
  add_view(g, lit, c);
  c.option(g.wish.points);
  return g.add(stage_in("points"), lit, c);
}

void add_light(GraphBuilder& g, int frame, Command& c) {
  const Decisions& d = g.decided(frame);
  const int lit = g.state(frame).lit_frame;
  c.content += g.state(frame).light;
  if (g.preview() && d.photons()) {
    c.file("--meshirrad", preview_light(g, lit));
  } else if (d.points()) {
    if (d.records()) {
      c.file("--irradcache", record_file(g, frame));
      c.file("--points", point_file(g, lit));
    } else {
      add_points(g, lit, c);
    }
  }
  if (d.caustic_map && !g.preview()) {
    if (moved(g, lit)) c.file("--photons", static_photons(g, lit));
    c.file(moved(g, lit) ? "--dynamic" : "--photons", photon_map(g, lit));
  }
}

}  // namespace tempolux
