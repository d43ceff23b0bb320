// lib/plan/walk_files.cpp -- the files of a walkthrough: key pictures, the intervals between them, warped pictures.
#include <algorithm>
#include <sstream>

#include "lib/plan/graph_builder.h"

namespace tempolux {
namespace {

/// An interval of a walkthrough: the frames between two keys, all with the same light.
struct Interval {
  int first = 0, last = 0;
  int middle() const { return first + (last - first) / 2; }
};

/// True if the keys of an interval and the frames between them show the same light. Otherwise warping would carry
/// light into a frame that does not have it.
bool same_light(const GraphBuilder& g, const Interval& interval) {
  for (int f = interval.first; f <= interval.last; ++f)
    if (g.state(f).light != g.state(interval.first).light) return false;
  return true;
}

std::string key_picture(GraphBuilder& g, int frame) {
  const bool layers = g.wish.filter > 0 || has_channel(g.wish.channels, "layers");
  const std::string channels = with_channels(g.wish.channels, layers ? "Z,N,id,layers" : "Z,N,id,specular");
  frame = shown_by(g, frame, channels);
  if (g.wish.filter > 0) return filtered_picture(g, frame, channels);
  return g.add(stage_in("keys"), frame, frame_command(g, frame, pixels_of(g, frame), channels));
}

/// Finds the interval of constant light that holds the frame between its keys; false if the frame is a key. Intervals
/// start at multiples of the key distance. An interval whose light changes is halved until its light is constant.
bool interval_around(const GraphBuilder& g, int frame, Interval& interval) {
  const int first = frame - frame % g.wish.key_distance;
  interval = {first, g.clamped(first + g.wish.key_distance)};
  while (frame > interval.first && frame < interval.last) {
    if (same_light(g, interval)) return true;
    (frame < interval.middle() ? interval.last : interval.first) = interval.middle();
  }
  return false;
}

/// The file that decides whether an interval is halved. It is made from the interval's keys and from the files of its
/// halves. "" if no frame lies between the keys.
std::string interval_file(GraphBuilder& g, const Interval& i) {
  if (i.last - i.first < 2) return "";
  const std::string name = frame_digits(i.first) + "+" + frame_digits(i.last);
  return g.once("interval " + name, [&] {
    const std::string left = interval_file(g, {i.first, i.middle()}), right = interval_file(g, {i.middle(), i.last});
    Command c;
    c.file("", key_picture(g, i.first));
    c.file("", key_picture(g, i.last));
    std::ostringstream threshold;
    threshold << 100 * g.wish.threshold << '%';
    for (const std::string& word : {frame_digits(i.middle()), key_picture(g, i.middle()), threshold.str(),
                                    left.empty() ? "-" : left, right.empty() ? "-" : right})
      c.option(word);
    c.content = g.tool_hash("aqm-compare") + g.cameras({i.middle()});
    return g.add(stage_in("walk"), name, c);
  });
}

}  // namespace

std::string walked_picture(GraphBuilder& g, int frame) {
  Interval interval;
  if (!interval_around(g, frame, interval)) return key_picture(g, frame);
  const std::string decided_by = interval_file(g, interval);
  if (std::ranges::find(g.graph.intervals, decided_by) == g.graph.intervals.end())
    g.graph.intervals.push_back(decided_by);
  Command c{"",
            {},
            g.tool_hash("ibr-warp") + (g.wish.filter > 0 ? g.tool_hash("st-filter") : "") + g.cameras({frame}) +
                in_data(g, frame, g.wish.channels)};
  c.file("", decided_by);
  c.option(frame_digits(frame));
  c.option(g.wish.filter > 0 ? g.wish.channels : "-");
  add_light(g, frame, c);
  for (const std::string& words :
       {g.size, pixels_of(g, frame),
        "--channels " + (g.wish.filter > 0 ? raw_channels(g.wish, g.wish.channels) : g.wish.channels)})
    c.option(words);
  return g.add(stage_in("walked"), frame, c);
}

}  // namespace tempolux
