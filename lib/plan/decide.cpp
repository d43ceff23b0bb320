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
#include "lib/plan/stages.h"
#include "lib/pilot/choose_light.h"
#include "lib/pilot/choose_preview.h"
#include "lib/pilot/choose_split.h"
#include "lib/pilot/hidden_light.h"
#include "lib/pilot/photon_shares.h"
#include "lib/pilot/pilot_photons.h"
#include "lib/pilot/places_seen.h"
#include "lib/pilot/seen_spheres.h"

namespace tempolux {
namespace {

/// Most frames that get a pilot because something begins to move or comes to rest there. Bounds the time of the pilots:
/// in 679 segments of 70 scenes at most three frames were of this kind.
constexpr std::size_t kMostEvents = 4;
/// Most pictures of a segment in which view_of() and new_share() look around: a bound of their time.
constexpr std::size_t kMostViews = 16;
/// Fewest states of light for which computing the light of the static scene first pays: it is computed once and every
/// state follows from it.
constexpr std::size_t kFewestStates = 3;
/// A segment departs from the shot's way to light if the shot's way needs more than this many times the work of the
/// segment's best way; departs() allows for the pilots' error besides.
constexpr double kDeparture = 1.3;
/// Fewest frames between two keys for which warping pays; with fewer every picture is a key or next to two keys.
constexpr std::size_t kFewestForKeys = 4;

// Stages by which reasons are found again.
constexpr const char* kRecordsReason = "irradcache-build records";
constexpr const char* kMovingReason = "photon-trace --map dynamic";
constexpr const char* kSplitReason = "photonmap-split";

/// Pilots look through a pinhole, so that decisions do not depend on the lens.
CameraView view_at(const SceneFrame& frame, const SceneSource& source, const Wish& wish) {
  PlacedCamera camera = frame.camera(source.camera_node);
  camera.camera.lens_radius_m = camera.camera.f_stop = 0;
  return CameraView(camera, frame.origin, wish.width, wish.height);
}

/// At most kMostViews of `frames`, evenly spaced.
std::vector<int> spread(const std::vector<int>& frames) {
  const std::size_t count = std::min(kMostViews, frames.size());
  std::vector<int> some;
  for (std::size_t i = 0; i < count; ++i) some.push_back(frames[i * frames.size() / count]);
  return some;
}

/// True if the user and the scene allow this way to light. Media exclude paths, because photons light media.
bool is_allowed(const Way& way, const Wish& wish, bool media) {
  return !(media && way.method == IndirectMethod::paths) &&
         (wish.indirect == "auto" || kIndirectMethods[std::size_t(way.method)] == wish.indirect);
}

/// The result of a rough frame: the ways to light, the best first, and the light paths of a photon map.
struct Look {
  std::vector<Way> ways;
  std::uint64_t paths = 0;
  /// True if every way with this method was measured.
  bool knows(IndirectMethod method) const {
    return std::ranges::all_of(ways, [&](const Way& way) { return way.method != method || way.measured; });
  }
};

/// How the pictures of a segment share light (Order::pictures, Order::records).
struct Sharing {
  double new_share = 0;  ///< Decisions::new_share
  double pictures = 1, records = 1;
  double least_hidden = kAuditLimit;  ///< RoughOptions::least_hidden
};

class FramePilot {
 public:
  /// tree: the pilots of a segment share the tree of its static scene.
  FramePilot(const Wish& wish, const SceneSource& source, int number, const std::string& kinds, StaticTree& tree)
      : kinds_(kinds),
        wish_(wish),
        frame_(source.at(number, true)),
        table_(source.emission(frame_.frame)),
        view_(view_at(frame_, source, wish)),
        tracer_(frame_, tree),
        lights_(frame_, table_) {}

  /// Renders a rough frame of `places` places. It ends early once enough(look) is true.
  Look look(int places, const Sharing& sharing, const std::function<bool(const Look&)>& enough) {
    const Lights& aimed_lights = aimed();
    const auto look_of = [&](const RoughFrame& rough) {
      Look look;
      look.paths = rough.paths_of_light;
      const bool filtered = wish_.filter != 0;
      const Order order{.pixels = double(wish_.width) * wish_.height,
                        .photons = look.paths,
                        .filtered = filtered,
                        .most_photons = filtered ? std::uint64_t(kMostTimesPhotons) * wish_.photons : 0,
                        .pictures = sharing.pictures,
                        .records = sharing.records};
      look.ways = ways_to_light(rough, order, kinds_.find("caustic") != std::string::npos);
      return look;
    };
    RoughOptions options{kinds_, wish_.pixel_error, wish_.photons, spheres_, 0, places};
    options.without_extent = without_extent_ ? &*without_extent_ : nullptr;
    options.least_hidden = sharing.least_hidden;
    options.enough = [&](const RoughFrame& rough) { return enough(look_of(rough)); };
    const Lights guided = guided_lights({tracer_, lights_, lights_.has_suns()}, view_);
    return look_of(rough_frame({tracer_, guided, lights_.has_suns()}, aimed_lights, view_, options));
  }

  PreviewPilot preview() { return pilot_preview({tracer_, aimed()}, kinds_, 0); }
  double kernel() { return pilot_kernel({tracer_, aimed()}, kinds_, 0); }
  SplitChoice split() { return choose_split(pilot_split({tracer_, lights_}, view_, 0)); }
  MovingPilot moving() { return pilot_moving({tracer_, lights_}, table_, view_, 0); }
  /// Mean share of a picture of the segment that the picture before does not show.
  double new_share(const PlannedSegment& segment) const {
    const std::vector<int> pictures = spread(segment.views());
    std::vector<PlacedCamera> cameras;
    for (const int frame : pictures)
      if (const auto& view = segment.at(frame).view) cameras.push_back(*view);
    const double steps = double(segment.views().size() - 1) / double(std::max<std::size_t>(2, pictures.size()) - 1);
    return tempolux::new_share(tracer_, cameras, wish_.width, wish_.height) / std::max(1.0, steps);
  }

 private:
  /// Lights whose photons are aimed where the camera looks, as in photon-trace.
  const Lights& aimed() {
    if (!aimed_) {
      EmissionTable table = table_;
      aim_at_seen(tracer_, view_, kinds_, table);
      spheres_ = table.aim;
      aimed_.emplace(frame_, table);
      if (may_hide_light(frame_)) without_extent_.emplace(frame_, table, Lights::Which::punctual);
    }
    return *aimed_;
  }

  std::string kinds_;
  const Wish& wish_;
  SceneFrame frame_;
  EmissionTable table_;
  CameraView view_;
  Tracer tracer_;
  Lights lights_;
  std::optional<Lights> aimed_, without_extent_;
  std::vector<AimSphere> spheres_;
};

std::string words(std::size_t count, const std::string& what) {
  return std::to_string(count) + " " + what + (count == 1 ? "" : "s");
}

std::string kinds_of(const MaterialFacts& materials, bool media) {
  std::string kinds = !materials.lambert ? "" : materials.other ? "caustic,indirect" : "indirect";
  if (media) kinds += kinds.empty() ? "volume" : ",volume";
  return kinds;
}

std::vector<Way> joined_ways(const std::vector<Look>& looks) {
  std::vector<std::vector<Way>> of_frames;
  for (const Look& look : looks) of_frames.push_back(look.ways);
  return joined(of_frames);
}

/// The best allowed way, if any is allowed.
std::optional<Way> best_of(const std::vector<Way>& ways, const Wish& wish, bool media) {
  const auto best = std::ranges::find_if(ways, [&](const Way& way) { return is_allowed(way, wish, media); });
  return best == ways.end() ? std::nullopt : std::optional(*best);
}

/// The way with a method and a source of caustic light; null if it is not there, as in a frame that sees no Lambert
/// lobe.
const Way* find_way(const std::vector<Way>& ways, IndirectMethod method, bool map) {
  const auto found = std::ranges::find_if(ways, [&](const Way& way) { return way.method == method && way.map == map; });
  return found == ways.end() ? nullptr : &*found;
}

/// The least ratio of scores at which a segment departs from the shot's way. error: standard error of its logarithm.
double departure(double error) { return kDeparture * std::exp(2 * error); }
/// The error of a single frame is not known and taken to be as large as kDeparture.
const double kErrorOfOne = std::log(kDeparture);

/// True if the ways of some frames are known well enough to follow the shot: its way is measured and misses no light,
/// and no bound of another way allows a departure (departs()).
bool may_follow(const std::vector<Way>& ways, std::size_t frames, const Wish& wish, bool media, const Decisions& shot) {
  const double least = departure(frames > 1 ? 0 : kErrorOfOne);
  const Way* const of_shot = find_way(ways, shot.indirect, shot.caustic_map);
  return of_shot && of_shot->measured && is_allowed(*of_shot, wish, media) && !(of_shot->never > 0) &&
         !(of_shot->uncertain > 0) && std::ranges::all_of(ways, [&](const Way& way) {
           return way.measured || way.score() * least >= of_shot->score();
         });
}

/// Measures each frame until its own best way has been measured, or until the segment may follow the shot. If the best
/// way of the whole segment is not measured at some of the frames, measures these frames again until it is. Sets
/// `middle` to the pilot of the frame in the middle.
struct Looking {
  const std::vector<int>& frames;
  const Wish& wish;
  bool media;
  std::function<std::unique_ptr<FramePilot>(int)> pilot_of;
  std::function<Sharing(const FramePilot&)> sharing_of;
  const Decisions* shot;  ///< its way must be measured, too; null: there is no shot
};
std::vector<Look> look_at(const Looking& looking, std::unique_ptr<FramePilot>& middle, Sharing& sharing) {
  const auto& [frames, wish, media, pilot_of, sharing_of, shot] = looking;
  const int places = (kPilotPlaces + int(frames.size()) - 1) / int(frames.size());
  std::vector<Look> looks;
  for (const int frame : frames) {
    std::unique_ptr<FramePilot> pilot = pilot_of(frame);
    if (looks.empty()) sharing = sharing_of(*pilot);
    looks.push_back(pilot->look(places, sharing, [&](const Look& look) {
      const Decisions* const of_shot = looking.shot;
      if (of_shot && may_follow(look.ways, looking.frames.size(), looking.wish, looking.media, *of_shot)) return true;
      const std::optional<Way> best = best_of(look.ways, looking.wish, looking.media);
      return (!best || best->measured) && (!of_shot || look.knows(of_shot->indirect));
    }));
    if (looks.size() == (frames.size() + 1) / 2) middle = std::move(pilot);
  }
  for (std::size_t i = 0; i < looks.size(); ++i) {
    const std::vector<Way> ways = joined_ways(looks);
    if (shot && may_follow(ways, frames.size(), wish, media, *shot)) break;
    const std::optional<Way> best = best_of(ways, wish, media);
    if (!best || looks[i].knows(best->method)) continue;
    looks[i] = pilot_of(frames[i])->look(places, sharing, [&](const Look& look) { return look.knows(best->method); });
    i = std::size_t(-1);  // the best way may have changed
  }
  return looks;
}

/// Does the segment have to depart from the shot's way to light? (decide.h)
bool departs(const std::vector<Look>& looks, const Wish& wish, bool media, const Decisions& shot) {
  const std::vector<Way> ways = joined_ways(looks);
  const std::optional<Way> best = best_of(ways, wish, media);
  if (!best) return false;
  const Way* const of_shot = find_way(ways, shot.indirect, shot.caustic_map);
  if (!of_shot || !is_allowed(*of_shot, wish, media)) return true;
  if (of_shot->never > best->never || of_shot->uncertain > best->uncertain) return true;
  // Mean and standard error of log(score of the shot's way / score of the best way) over the frames.
  double n = 0, sum = 0, squares = 0;
  for (const Look& look : looks) {
    const Way* const shots = find_way(look.ways, shot.indirect, shot.caustic_map);
    const Way* const bests = find_way(look.ways, best->method, best->map);
    if (!shots || !bests) continue;
    const double ratio = std::log(std::max(shots->score(), 1e-300) / std::max(bests->score(), 1e-300));
    n += 1;
    sum += ratio;
    squares += ratio * ratio;
  }
  const double error = n > 1 ? std::sqrt(std::max(0.0, squares / n - sum * sum / (n * n)) / (n - 1)) : kErrorOfOne;
  return of_shot->score() > best->score() * departure(error);
}

/// Sets the decisions about indirect light so that they suit every measured frame.
void join(const std::vector<Look>& looks, const Wish& wish, bool media, Decisions& d) {
  d.photon_paths = 0;
  for (const Look& look : looks) d.photon_paths = std::max(d.photon_paths, look.paths);
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
void decide_moving(const PlannedSegment& segment, const Wish& wish, bool media, const SceneSource& source,
                   StaticTree& tree, Decisions& d) {
  const auto anew = [&](const std::string& because) { d.reasons.push_back({kMovingReason, because}); };
  const std::vector<int> states = segment.states();
  if (!d.points() || states.size() < kFewestStates)
    return anew(words(states.size(), "state") + " of light in the segment");
  if (media && wish.moving != "auto" && wish.moving != "anew")
    throw InputError("--moving " + wish.moving +
                     ": the scene has media, which all light meets: what movers change of it cannot be told apart; use "
                     "--moving anew");
  if (media) return anew("there are media, which all light meets");
  if (wish.moving == "anew") return anew("--moving anew");
  const MovingChoice choice =
      wish.moving == "auto"
          ? choose_moving(FramePilot(wish, source, states[states.size() / 2], d.kinds, tree).moving(), states.size(),
                          part_of_records(segment, d.new_share))
          : MovingChoice{*named<MovingMethod>(kMovingMethods, wish.moving), "--moving " + wish.moving};
  d.moving = choice.method;
  if (d.moving > MovingMethod::light && !d.records()) d.moving = MovingMethod::light;
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
void decide_preview(const PlannedSegment& segment, const std::vector<int>& view_frames, const Wish& wish,
                    const SceneSource& source, StaticTree& tree, Decisions& d) {
  d.indirect = IndirectMethod::paths;
  std::vector<PreviewPilot> pilots;
  double kernel = 0;
  for (const int frame : d.looked) {
    FramePilot pilot(wish, source, frame, d.kinds, tree);
    if (frame == d.looked[d.looked.size() / 2]) kernel = pilot.kernel();
    pilots.push_back(pilot.preview());
  }
  const PreviewChoice choice = choose_preview(pilots, kernel, wish.photons, kPreviewWindow);
  d.photon_paths = choice.paths;
  d.texture_width = choice.width;
  d.view = view_of(view_frames, d.kinds, wish, source, tree);
  d.reasons.push_back(density_reason(segment));
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

std::vector<int> frames_of(std::span<const PlannedSegment> pieces) {
  std::vector<int> frames;
  for (int f = pieces.front().first; f <= pieces.back().last; ++f) frames.push_back(f);
  return frames;
}

std::string view_of(const std::vector<int>& frames, const std::string& kinds, const Wish& wish,
                    const SceneSource& source, StaticTree& tree) {
  SeenAround around;
  double radius = 0;
  std::set<std::string> cameras, states;
  const std::vector<int> some = spread(frames);
  for (const int number : some) {
    const SceneFrame frame = source.at(number, false);
    const PlacedCamera camera = frame.camera(source.camera_node);
    if (!cameras.insert(pinhole_hash(camera)).second) continue;
    const EmissionTable table = source.emission(frame.frame);
    radius = std::max(radius, table.sphere_radius);
    look_around(Tracer(frame, tree), camera, wish.width, wish.height, around);
    // Only photons of distant light are aimed, and only those of several lights have shares. Else the aim serves the
    // points alone, and the first picture decides whether the scene is large enough for an aim.
    if (number == frames.front() && !frame.scene->has_distant_light() && !has_several_lights(frame, table) &&
        !seen_spheres(around.places, radius).worth_aiming)
      return "";
  }
  SeenSpheres seen = seen_spheres(around.places, radius);
  SharePilot pilot(seen.spheres, around.places, kinds);
  for (const int number : {some.front(), some[some.size() / 2], some.back()}) {
    const SceneFrame frame = source.at(number, false);
    const SceneHashes& hashes = frame.hashes;
    if (!states.insert(hash_of_texts({hashes.moving_geometry, hashes.materials, hashes.lights})).second) continue;
    EmissionTable table = source.emission(number);
    if (seen.worth_aiming) table.aim = spheres_in_scene(seen.spheres, frame.origin);
    if (has_several_lights(frame, table)) pilot.look(Tracer(frame, tree), table);
  }
  if (!seen.worth_aiming) seen.spheres.clear();
  const formats::View view{std::move(seen.spheres), pilot.shares()};
  return view.spheres.empty() && view.lights.empty() ? "" : formats::view_text(view);
}

namespace {

/// Decisions that need no pilot.
Decisions begin(const PlannedSegment& segment, bool media) {
  Decisions d;
  d.kinds = kinds_of(segment.materials, media);
  d.reasons.push_back({"photon-trace", segment.materials.lambert ? "some material reflects by a Lambert lobe"
                                                                 : "nothing reflects by a Lambert lobe"});
  return d;
}

/// True if the light of the static scene may be computed once for all states of the segment.
bool may_share_static(const PlannedSegment& segment, const Wish& wish, bool media) {
  return segment.states().size() >= kFewestStates && !media && wish.moving != "anew";
}

/// Mean number of pictures that share the light paths of a photon map. The paths of the static scene are traced a
/// second time to find those that movers touch.
double pictures_of_a_map(const PlannedSegment& segment, const Wish& wish, bool media) {
  const auto pictures = double(segment.pictures().size()), states = double(segment.states().size());
  return std::max(1.0, may_share_static(segment, wish, media) ? pictures / 2 : pictures / states);
}

/// If the light of the static scene is shared, each state gathers further records where movers matter: at least
/// kLeastRecords, and about as many again as its part of the static ones.
Sharing sharing_in(const PlannedSegment& segment, const Wish& wish, bool media, const FramePilot& pilot) {
  Sharing sharing{.pictures = pictures_of_a_map(segment, wish, media)};
  if (segment.views().size() < 2) return sharing;
  sharing.new_share = pilot.new_share(segment);
  const double part = part_of_records(segment, sharing.new_share);
  if (segment.states().size() == 1) sharing.records = part;
  else if (may_share_static(segment, wish, media)) sharing.records = std::min(1.0, 2 * part + kLeastRecords);
  return sharing;
}

/// What pilots found in the frames `d.looked`.
struct LookedAt {
  StaticTree tree;
  std::unique_ptr<FramePilot> middle;
  std::vector<Look> looks;
  Sharing sharing;

  /// shot: the decisions of the shot; its way must be measured, too.
  LookedAt(const PlannedSegment& segment, const Wish& wish, bool media, const SceneSource& source, const Decisions& d,
           const Decisions* shot, double least_hidden = kAuditLimit) {
    const auto pilot_of = [&](int frame) { return std::make_unique<FramePilot>(wish, source, frame, d.kinds, tree); };
    const auto sharing_of = [&](const FramePilot& pilot) {
      Sharing found = sharing_in(segment, wish, media, pilot);
      found.least_hidden = least_hidden;
      return found;
    };
    looks = look_at({d.looked, wish, media, pilot_of, sharing_of, shot}, middle, sharing);
  }
};

/// Decides how many pictures share records.
void decide_together(const PlannedSegment& segment, double new_share, Decisions& d) {
  if (d.records()) d.new_share = new_share;
  d.together = pictures_together(segment.views().size(), d.new_share);
}

/// Decides about the light by what pilots found; `segment` supplies the pictures and the movers.
void decide_by_looks(const PlannedSegment& segment, const Wish& wish, bool media, const SceneSource& source,
                     LookedAt& looked, Decisions& d) {
  join(looked.looks, wish, media, d);
  decide_together(segment, looked.sharing.new_share, d);
  decide_moving(segment, wish, media, source, looked.tree, d);
  if (may_share_static(segment, wish, media) && d.moving == MovingMethod::anew) {
    // Each state traces its own map, so further light paths cost more than was planned.
    d.photon_paths = 0;
    for (const Look& look : looked.looks) d.photon_paths = std::max(d.photon_paths, look.paths);
  }
  decide_split(*looked.middle, wish, d);
}

/// Decides about the light without a shot. `view_frames`: the frames from which view_of() looks.
void decide_light(const PlannedSegment& segment, const std::vector<int>& view_frames, const Wish& wish, bool media,
                  const SceneSource& source, Decisions& d, double least_hidden = kAuditLimit) {
  if (wish.method == FrameMethod::preview) {
    StaticTree tree;
    return decide_preview(segment, view_frames, wish, source, tree, d);
  }
  LookedAt looked(segment, wish, media, source, d, nullptr, least_hidden);
  decide_by_looks(segment, wish, media, source, looked, d);
  if (d.photons()) d.view = view_of(view_frames, d.kinds, wish, source, looked.tree);
}

/// Copies the shot's decisions about the light.
void copy_shot(const PlannedSegment& segment, const Decisions& shot, const LookedAt& looked, Decisions& d) {
  d.indirect = shot.indirect;
  d.caustic_map = shot.caustic_map;
  d.record_rays = shot.record_rays;
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
void take_from_shot(const PlannedSegment& segment, const Wish& wish, bool media, const SceneSource& source,
                    const Decisions& shot, Decisions& d) {
  LookedAt looked(segment, wish, media, source, d, &shot);
  if (departs(looked.looks, wish, media, shot)) {
    decide_by_looks(segment, wish, media, source, looked, d);
    std::ranges::find(d.reasons, kRecordsReason, &Reason::stage)->because +=
        "; the shot's way costs more here by more than pilots err";
  } else {
    copy_shot(segment, shot, looked, d);
  }
  if (d.photons()) d.view = shot.view;
}

/// Throws InputError for a wish that the scene cannot fulfil.
void refuse_paths(const Wish& wish, bool media) {
  if (wish.indirect == "paths" && media)
    throw InputError("--indirect paths: the scene has media, which photons light; choose records or gather");
}

}  // namespace

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
  if (d.photons()) decide_light(moving, frames_of(pieces), wish, media, source, d, kAuditLimit / 2);
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
    decide_light(segment, frames_of({&segment, 1}), wish, media, source, d);
  } else if (wish.method == FrameMethod::preview) {
    d.indirect = shot->indirect;
    d.photon_paths = shot->photon_paths;
    d.texture_width = shot->texture_width;
    d.view = shot->view;
    d.reasons.push_back(density_reason(segment));
  } else {
    take_from_shot(segment, wish, media, source, *shot, d);
  }
  decide_walk(segment, d);
  return d;
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
