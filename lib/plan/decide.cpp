// lib/plan/decide.cpp -- makes all decisions of a shot and its segments; lib/pilot's choose_*.h hold the measurements
// behind each.
#include "lib/plan/decide.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <memory>
#include <optional>
#include <set>

#include "formats/error.h"
#include "formats/hash.h"
#include "lib/core/formatted.h"
#include "lib/plan/looks.h"
#include "lib/plan/stages.h"
#include "lib/plan/view_of.h"

namespace tempolux {
namespace {

/// Most frames that get a pilot because something begins to move or comes to rest there. Bounds the time of the pilots:
/// in 679 segments of 70 scenes at most three frames were of this kind.
constexpr std::size_t kMostEvents = 4;
/// Fewest states of light for which computing the light of the static scene first pays: it is computed once and every
/// state follows from it.
constexpr std::size_t kFewestStates = 3;
/// Fewest frames between two keys for which warping pays; with fewer every picture is a key or next to two keys.
constexpr std::size_t kFewestForKeys = 4;

// Reasons of decisions are stored under these stages (Reason::stage).
constexpr const char* kRecordsReason = "irradcache-build records";
constexpr const char* kMovingReason = "photon-trace --map dynamic";
constexpr const char* kSplitReason = "photonmap-split";
constexpr const char* kStillReason = "frame-render --still";

/// Largest factor by which the work of a frame exceeds the work that the pilot of decide_still() finds
/// (docs/methods/still.md).
constexpr double kStillPilotError = 2;

/// What is decided about.
struct Deciding {
  const PlannedSegment& segment;  ///< supplies the pictures and the movers
  const Wish& wish;
  bool media;
  const SceneSource& source;
};

std::string words(std::size_t count, const std::string& what) {
  return std::to_string(count) + " " + what + (count == 1 ? "" : "s");
}

/// Kinds of photons that surfaces of these materials, and media, can need: Decisions::kinds before a way is chosen.
std::string kinds_of(const MaterialFacts& materials, bool media) {
  std::string kinds = !materials.lambert ? "" : materials.other ? "caustic,indirect" : "indirect";
  if (media) kinds += kinds.empty() ? "volume" : ",volume";
  return kinds;
}

/// Sets the decisions about indirect light: the way that is best for all measured frames together, and its numbers.
void join(const std::vector<FrameWays>& looks, const Wish& wish, bool media, Decisions& d) {
  d.photon_paths = 0;
  for (const FrameWays& look : looks) d.photon_paths = std::max(d.photon_paths, look.paths);
  const std::vector<Way> ways = joined_ways(looks);
  std::string words = because(ways);
  if (wish.indirect != "auto") words = "--indirect " + wish.indirect + "; " + words;
  // If the camera sees no Lambert lobe, paths are the only way. If the user asks for records all the same, they get one
  // ray each.
  const Way way =
      best_of(ways, wish, media)
          .value_or(
              Way{.method = named<IndirectMethod>(kIndirectMethods, wish.indirect).value_or(IndirectMethod::gather),
                  .rays = 1});
  d.indirect = way.method;
  d.caustic_map = way.map;
  d.record_rays = way.rays;
  if (way.map) d.photon_paths = std::max(d.photon_paths, way.photons);
  d.pixel_error = wish.pixel_error * way.pixel_error;
  if (d.indirect == IndirectMethod::paths) d.kinds = way.map ? "caustic" : "";
  d.reasons.push_back({kRecordsReason, words});
}

void decide_split(FramePilot& pilot, const Wish& wish, Decisions& d) {
  if (!d.points()) return;
  const SplitChoice choice =
      wish.split == "auto" ? pilot.split() : SplitChoice{wish.split == "on", "--split " + wish.split};
  if (wish.split == "on" && wish.moving == "records")
    throw InputError(
        "--split on with --moving records: records that follow from static records have no bright points; use "
        "--moving time or anew");
  d.split = choice.split && d.moving != MovingMethod::records;
  d.reasons.push_back({kSplitReason, choice.split && !d.split ? "records follow from static records" : choice.because});
}

/// Number of pictures that share records: the largest power of two whose joint records cost at most twice as much as
/// one picture's own records. A single requested frame then costs at most twice its minimum.
int pictures_together(std::size_t pictures, double new_share) {
  int together = 1;
  while (std::size_t(together) < pictures && Decisions::records_of(2 * together, new_share) <= 2) together *= 2;
  return together;
}

/// A picture's part of the records that consecutive pictures of a segment share.
double part_of_records(const PlannedSegment& segment, double new_share) {
  const std::size_t pictures = segment.views().size();
  const double together = std::min<double>(pictures_together(pictures, new_share), double(pictures));
  return Decisions::records_of(together, new_share) / together;
}

/// Decides which parts of a frame's light (photons, points, records) are derived from the light of the static scene.
void decide_moving(const Deciding& about, StaticTree& tree, Decisions& d) {
  const Wish& wish = about.wish;
  const auto anew = [&](const std::string& because) { d.reasons.push_back({kMovingReason, because}); };
  const std::vector<int> states = about.segment.states();
  if (!d.points() || states.size() < kFewestStates)
    return anew(words(states.size(), "state") + " of light in the segment");
  if (about.media && wish.moving != "auto" && wish.moving != "anew")
    throw InputError("--moving " + wish.moving +
                     ": the scene has media, which all light meets: what movers change of it cannot be told apart; use "
                     "--moving anew");
  if (about.media) return anew("there are media, which all light meets");
  if (wish.moving == "anew") return anew("--moving anew");
  const MovingChoice choice =
      wish.moving == "auto"
          ? choose_moving(FramePilot(wish, about.source, states[states.size() / 2], d.kinds, tree).moving(),
                          states.size(), part_of_records(about.segment, d.new_share))
          : MovingChoice{*named<MovingMethod>(kMovingMethods, wish.moving), "--moving " + wish.moving};
  d.moving = choice.method;
  if (d.moving > MovingMethod::light && !d.records()) d.moving = MovingMethod::light;
  d.static_ray_factor = choice.static_ray_factor;
  d.reasons.push_back({kMovingReason, choice.because});
}

/// Decides whether warping can make pictures between key frames.
void decide_walk(const PlannedSegment& segment, Decisions& d) {
  const std::size_t pictures = segment.views().size(), states = segment.states().size();
  std::string because;
  if (segment.is_blurred()) because = "lens or shutter blur the pictures: warping moves sharp ones only";
  else if (pictures < kFewestForKeys) because = words(pictures, "different picture") + ": too few to lie between keys";
  else if (pictures == states)
    because = "light transport differs in all " + words(pictures, "picture") + ": keys lend little light to others";
  else
    because = "the camera moves through " + words(pictures, "picture") + " of " + words(states, "state") + " of light";
  d.walk = !segment.is_blurred() && pictures >= kFewestForKeys && pictures > states;
  d.reasons.push_back({"ibr-warp", because});
}

Reason density_reason(const PlannedSegment& segment) {
  return {"gather-temporal density", words(segment.states().size(), "state") + " of light in the segment"};
}

/// For light textures: the number of light paths that stores the wanted photons, and the width of the filter.
void decide_preview(const Deciding& about, const std::vector<int>& view_frames, StaticTree& tree, Decisions& d) {
  d.indirect = IndirectMethod::paths;
  std::vector<PreviewPilot> pilots;
  double kernel = 0;
  for (const int frame : d.looked) {
    FramePilot pilot(about.wish, about.source, frame, d.kinds, tree);
    if (frame == d.looked[d.looked.size() / 2]) kernel = pilot.kernel();
    pilots.push_back(pilot.preview());
  }
  const PreviewChoice choice = choose_preview(pilots, kernel, about.wish.photons, kPreviewWindow);
  d.photon_paths = choice.paths;
  d.texture_width = choice.width;
  d.view = view_of(view_frames, d.kinds, about.wish, about.source, tree);
  d.reasons.push_back(density_reason(about.segment));
}

/// Decisions that need no pilot.
Decisions begin(const PlannedSegment& segment, bool media) {
  Decisions d;
  d.kinds = kinds_of(segment.materials, media);
  d.reasons.push_back({"photon-trace", segment.materials.lambert ? "some material reflects by a Lambert lobe"
                                                                 : "nothing reflects by a Lambert lobe"});
  return d;
}

/// True if the light of the static scene may be computed once for all states of the segment.
bool may_share_static(const Deciding& about) {
  return about.segment.states().size() >= kFewestStates && !about.media && about.wish.moving != "anew";
}

/// Mean number of pictures that share the light paths of a photon map. If the light of the static scene is shared, its
/// paths are traced twice, the second time to find the paths that movers touch; so the number of pictures is halved.
double pictures_of_a_map(const Deciding& about) {
  const auto pictures = double(about.segment.pictures().size()), states = double(about.segment.states().size());
  return std::max(1.0, may_share_static(about) ? pictures / 2 : pictures / states);
}

/// How the pictures of the segment share light. If they share the light of the static scene, each state of light
/// gathers further records where movers matter: at least the share kLeastRecords of a picture's records, and as many
/// again as its part of the static records.
LightSharing sharing_in(const Deciding& about, const FramePilot& pilot) {
  const PlannedSegment& segment = about.segment;
  LightSharing sharing{.pictures = pictures_of_a_map(about)};
  if (segment.views().size() < 2) return sharing;
  sharing.new_share = pilot.new_share(segment);
  const double part = part_of_records(segment, sharing.new_share);
  if (segment.states().size() == 1) sharing.records = part;
  else if (may_share_static(about)) sharing.records = std::min(1.0, 2 * part + kLeastRecords);
  return sharing;
}

/// The results of the pilots in the frames `d.looked`, and what later pilots reuse of them.
struct LookedAt {
  StaticTree tree;
  std::unique_ptr<FramePilot> middle;
  std::vector<FrameWays> looks;
  LightSharing sharing;

  /// shot: the decisions of the shot; its way must be measured, too.
  LookedAt(const Deciding& about, const Decisions& d, const Decisions* shot, double least_hidden = kAuditLimit) {
    const auto pilot_of = [&](int frame) {
      return std::make_unique<FramePilot>(about.wish, about.source, frame, d.kinds, tree);
    };
    const auto sharing_of = [&](const FramePilot& pilot) {
      LightSharing found = sharing_in(about, pilot);
      found.least_hidden = least_hidden;
      return found;
    };
    looks = look_at({d.looked, about.wish, about.media, pilot_of, sharing_of, shot}, middle, sharing);
  }
};

/// Decides how many pictures share records.
void decide_together(const PlannedSegment& segment, double new_share, Decisions& d) {
  if (d.records()) d.new_share = new_share;
  d.together = pictures_together(segment.views().size(), d.new_share);
}

/// Decides about the light by what pilots found.
void decide_by_looks(const Deciding& about, LookedAt& looked, Decisions& d) {
  join(looked.looks, about.wish, about.media, d);
  decide_together(about.segment, looked.sharing.new_share, d);
  decide_moving(about, looked.tree, d);
  if (may_share_static(about) && d.moving == MovingMethod::anew) {
    // Each state traces its own map, so further light paths cost more than was planned.
    d.photon_paths = 0;
    for (const FrameWays& look : looked.looks) d.photon_paths = std::max(d.photon_paths, look.paths);
  }
  decide_split(*looked.middle, about.wish, d);
}

/// Decides about the light without a shot. `view_frames`: the frames from which view_of() looks.
void decide_light(const Deciding& about, const std::vector<int>& view_frames, Decisions& d,
                  double least_hidden = kAuditLimit) {
  if (about.wish.method == FrameMethod::preview) {
    StaticTree tree;
    return decide_preview(about, view_frames, tree, d);
  }
  LookedAt looked(about, d, nullptr, least_hidden);
  decide_by_looks(about, looked, d);
  if (d.photons()) d.view = view_of(view_frames, d.kinds, about.wish, about.source, looked.tree);
}

/// Copies the shot's decisions about the light.
void copy_shot(const PlannedSegment& segment, const Decisions& shot, const LookedAt& looked, Decisions& d) {
  d.indirect = shot.indirect;
  d.caustic_map = shot.caustic_map;
  d.record_rays = shot.record_rays;
  d.static_ray_factor = shot.static_ray_factor;
  d.pixel_error = shot.pixel_error;
  d.photon_paths = shot.photon_paths;
  if (d.indirect == IndirectMethod::paths) d.kinds = shot.caustic_map ? "caustic" : "";
  d.reasons.push_back({kRecordsReason, "as in the whole shot; here " + because(joined_ways(looked.looks))});
  decide_together(segment, looked.sharing.new_share, d);
  if (segment.states().size() >= kFewestStates && d.points()) d.moving = shot.moving;
  if (d.points()) d.split = shot.split && d.moving != MovingMethod::records;
  for (const char* stage : {kMovingReason, kSplitReason}) {
    const auto reason = std::ranges::find(shot.reasons, stage, &Reason::stage);
    if (reason != shot.reasons.end()) d.reasons.push_back({stage, "as in the whole shot; there " + reason->because});
  }
}

/// Takes the shot's decisions about the light where they suit the segment.
void take_from_shot(const Deciding& about, const Decisions& shot, Decisions& d) {
  LookedAt looked(about, d, &shot);
  if (departs(looked.looks, about.wish, about.media, shot)) {
    decide_by_looks(about, looked, d);
    std::ranges::find(d.reasons, kRecordsReason, &Reason::stage)->because +=
        "; the shot's way costs more here by more than pilots err";
  } else {
    copy_shot(about.segment, shot, looked, d);
  }
  if (d.photons()) d.view = shot.view;
}

/// Throws InputError for a wish that the scene cannot fulfil.
void refuse_paths(const Wish& wish, bool media) {
  if (wish.indirect == "paths" && media)
    throw InputError("--indirect paths: the scene has media, which photons light; choose records or gather");
}

}  // namespace

std::vector<int> looked_frames(const PlannedSegment& segment, bool of_shot) {
  std::set<int> looked{segment.first + (segment.last - segment.first) / 2};
  if (!of_shot) looked.insert({segment.first, segment.last});
  std::size_t events = 0;
  for (std::size_t i = 1; i < segment.frames.size() && events < kMostEvents; ++i) {
    const auto light = [&](std::size_t k) { return segment.frames[k].light; };
    if (light(i) == light(i - 1)) continue;
    const bool begins = i >= 2 && light(i - 1) == light(i - 2),
               comes_to_rest = i + 1 < segment.frames.size() && light(i) == light(i + 1);
    if (!begins && !comes_to_rest) continue;
    events += looked.insert(segment.frames[i].frame).second;
  }
  std::set<int> pictures;
  std::vector<int> frames;
  for (const int frame : looked)
    if (pictures.insert(segment.at(frame).viewed).second) frames.push_back(frame);
  return frames;
}

Decisions decide_shot(const std::vector<PlannedSegment>& pieces, const Wish& wish, bool media,
                      const SceneSource& source) {
  if (pieces.size() == 1) return decide(pieces.front(), wish, media, source);
  // The piece with the most states of light decides about movers.
  const PlannedSegment& moving =
      *std::ranges::max_element(pieces, {}, [](const PlannedSegment& piece) { return piece.states().size(); });
  Decisions d = begin(moving, media);
  d.pixel_error = wish.pixel_error;
  const PlannedSegment& middle = pieces[pieces.size() / 2];
  d.looked = {pieces.front().first, middle.first + (middle.last - middle.first) / 2, pieces.back().last};
  refuse_paths(wish, media);
  // Light that paths never find counts from half of the share on from which it counts in a segment. Else a share near
  // the limit would be found in some segments alone, and the light would jump where they meet.
  if (d.photons()) decide_light({moving, wish, media, source}, frames_of(pieces), d, kAuditLimit / 2);
  return d;
}

Decisions decide(const PlannedSegment& segment, const Wish& wish, bool media, const SceneSource& source,
                 const Decisions* shot) {
  Decisions d = begin(segment, media);
  d.pixel_error = wish.pixel_error;
  d.looked = looked_frames(segment, shot != nullptr);
  refuse_paths(wish, media);
  if (!d.photons()) {
    decide_walk(segment, d);
    return d;
  }
  if (!shot) {
    decide_light({segment, wish, media, source}, frames_of({&segment, 1}), d);
  } else if (wish.method == FrameMethod::preview) {
    d.indirect = shot->indirect;
    d.photon_paths = shot->photon_paths;
    d.texture_width = shot->texture_width;
    d.view = shot->view;
    d.reasons.push_back(density_reason(segment));
  } else {
    take_from_shot({segment, wish, media, source}, *shot, d);
  }
  decide_walk(segment, d);
  return d;
}

void decide_still(const PlannedSegment& segment, const PlannedFrame& middle, int shot_frames, const Wish& wish,
                  bool media, const SceneSource& source, Decisions& d) {
  std::vector<int> others;
  for (const PlannedFrame& frame : segment.frames)
    if (frame.camera == middle.camera && frame.light != middle.light) others.push_back(frame.frame);
  const auto because = [&](const std::string& why) { d.reasons.push_back({kStillReason, why}); };
  if (media) return because("there are media, which all light meets");
  if (segment.is_blurred()) return because("lens or shutter blur the pictures");
  if (!wish.preset_pixels) return because("the user gives the options of pixels");
  if (wish.filter > 1) return because("the frames of a filter's window need independent noise");
  if (others.empty()) return because("no frame has the camera of the shot's middle frame and other light");
  StaticTree tree, middle_tree;
  const int number = others[others.size() / 2];
  const FramePilot now(wish, source, number, d.kinds, tree), before(wish, source, middle.frame, d.kinds, middle_tree);
  const double work = now.still_work(before, d), of_middle = kFinerStillSamples / shot_frames;
  d.still = kStillPilotError * work + of_middle < 1;
  because(
      formatted("a frame that keeps pixels of frame %d has %.2f of the work of one that keeps none, and a part of "
                "frame %d's: %.2f",
                middle.frame, work, middle.frame, of_middle));
}

std::string decision_key(const PlannedSegment& segment, const Wish& wish, bool media) {
  Hasher hasher;
  for (const PlannedFrame& frame : segment.frames) {
    hasher.add(frame.light);
    hasher.add(frame.pinhole);
  }
  hasher.add(double(segment.is_blurred()));
  hasher.add(segment.static_scene);
  for (const std::string& word : {wish.indirect, wish.moving, wish.split, wish.common}) hasher.add(word);
  hasher.add(double(wish.method == FrameMethod::preview));
  for (const double number :
       {double(wish.width), double(wish.height), double(wish.photons), wish.pixel_error, double(media)})
    hasher.add(number);
  return hasher.hex();
}

}  // namespace tempolux
