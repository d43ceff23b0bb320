// lib/plan/picture_files.cpp -- the files of pictures: rendered, filtered, with smoke.
#include <iomanip>
#include <optional>
#include <sstream>
#include <tuple>

#include "formats/hash.h"
#include "lib/plan/graph_builder.h"

namespace tempolux {
namespace {

/// The audit traces this share of the frame's rays. With its look-ups an audit takes less than 3 % of a run.
constexpr const char* kAudit = "--audit 0.02";

/// The options of a frame's pixels, with `finer` times the pixel error.
std::string pixels_with(const GraphBuilder& g, int frame, double finer) {
  if (!g.wish.preset_pixels) return g.wish.pixels;
  std::ostringstream words;
  words << g.wish.pixels << " --pixel-error " << std::setprecision(2) << g.decided(frame).pixel_error * finer;
  return words.str();
}

/// METHOD=still: the frame that gives `frame` the kept pixels, which is the frame in the middle of the shot. Empty if
/// `frame` has another camera than the middle frame, if lens or shutter blur it, or if the two frames read different
/// kinds of light files.
std::optional<int> still_frame(const GraphBuilder& g, int frame) {
  const bool wanted =
      g.wish.method == FrameMethod::still || (g.wish.method == FrameMethod::automatic && g.decided(frame).still);
  if (!wanted || g.plan.media) return {};
  const std::optional<int> middle = g.plan.middle();
  if (!middle) return {};
  const PlannedFrame &there = g.state(*middle), &here = g.state(frame);
  const auto files = [&](int of) {
    const Decisions& d = g.decided(of);
    return std::tuple(d.kinds, d.indirect, d.caustic_map, d.split);
  };
  if (there.camera != here.camera || g.segment(frame).is_blurred() || files(*middle) != files(frame)) return {};
  return there.picture;
}

/// A sampled frame, which is filtered later (stage raw) or not at all. With METHOD=still it takes kept pixels from the
/// frame in the middle of the shot. If both frames have the same light, a raw frame is the middle frame itself.
std::string sampled_picture(GraphBuilder& g, const StageInfo& stage, int frame, const std::string& words,
                            const std::string& channels) {
  Command c = frame_command(g, frame, pixels_of(g, frame) + words, channels);
  const std::optional<int> still = still_frame(g, frame);
  if (!still) return g.add(stage, frame, c);
  const int from = *still;
  const std::string base =
      g.add(stage_in("still"), from, frame_command(g, from, pixels_with(g, from, kFinerStill) + words, channels));
  if (g.state(from).light == g.state(frame).light) return stage.folder == "raw" ? base : g.add(stage, frame, c);
  c.file("--still", base);
  c.option("--still-frame " + std::to_string(from));
  Command light{"", {}, ""};
  add_light(g, from, light);
  c.append(light, "--still-");
  return g.add(stage, frame, c);
}

std::string clear_picture(GraphBuilder& g, int frame) {
  if (g.wish.method == FrameMethod::walkthrough) return walked_picture(g, frame);
  if (g.wish.filter > 0) return filtered_picture(g, frame, g.wish.channels);
  return sampled_picture(g, stage_in("pictures"), frame, "", g.wish.channels);
}

}  // namespace

std::string raw_channels(const Wish& wish, const std::string& filtered) {
  return with_channels(
      std::string("RGBA,layers,Z,N,id,albedo,coverage,halves,seen") + (wish.filter > 1 ? ",motion" : ""), filtered);
}

std::string in_data(const GraphBuilder& g, int frame, const std::string& channels) {
  const std::string names = has_channel(channels, "cryptomatte") ? g.plan.names : "";
  if (!has_channel(channels, "motion")) return names;
  const PlannedFrame &before = g.state(g.clamped(frame - 1)), &here = g.state(frame),
                     &after = g.state(g.clamped(frame + 1));
  return hash_of_texts({before.light, before.camera, here.light, here.camera, after.light, after.camera}) + names;
}

std::string pixels_of(const GraphBuilder& g, int frame) { return pixels_with(g, frame, 1); }

Command frame_command(GraphBuilder& g, int frame, const std::string& pixels, const std::string& channels) {
  Command c{"--frame " + std::to_string(frame), {}, g.cameras({frame}) + in_data(g, frame, channels)};
  add_light(g, frame, c);
  for (const std::string& words : {g.size, pixels, "--channels " + channels}) c.option(words);
  c.option(kAudit);
  return c;
}

int shown_by(const GraphBuilder& g, int frame, const std::string& channels) {
  if (!has_channel(channels, "motion")) return g.state(frame).picture;
  for (int f = g.segment(frame).first + 1; f < frame; ++f)
    if (g.state(f).picture == g.state(frame).picture && in_data(g, f, channels) == in_data(g, frame, channels))
      return f;
  return frame;
}

std::string filtered_picture(GraphBuilder& g, int frame, const std::string& channels) {
  // The frames of a window need independent noise.
  const std::string words = std::string(g.wish.filter > 1 ? " --seed-mode frame" : "") + " --compression none";
  const std::string raw_names = raw_channels(g.wish, channels);
  Command c;
  std::size_t position = 0;
  for (int f = frame - g.wish.filter / 2; f <= frame + g.wish.filter / 2; ++f) {
    if (f != g.clamped(f)) continue;
    const int like = shown_by(g, f, raw_names);
    const std::string raw = sampled_picture(g, stage_in("raw"), like, words, raw_names);
    if (c.inputs.empty() || c.inputs.back() != raw) c.file("", raw);
    if (f == frame) position = c.inputs.size();
  }
  c.option("--position " + std::to_string(position) + " --channels " + channels);
  return g.add(stage_in("filtered"), frame, c);
}

std::string picture_file(GraphBuilder& g, int frame) {
  frame = shown_by(g, frame, g.wish.channels);
  const std::string clear = clear_picture(g, frame);
  if (!g.plan.media) return clear;
  const int lit = g.state(frame).lit_frame;
  Command c{"--frame " + std::to_string(frame), {}, g.state(frame).light + g.cameras({frame})};
  c.file("--base", clear);
  c.file("--photons", refined_photon_map(g, lit));
  if (g.decided(frame).points()) c.file("--points", point_file(g, lit));
  c.option(g.wish.smoke_words);
  return g.add(stage_in("smoky"), frame, c);
}

}  // namespace tempolux
