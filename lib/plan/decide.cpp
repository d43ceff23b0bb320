// lib/plan/decide.cpp -- one place decides; lib/render's choose_*.h hold the measurements behind each choice.
#include "lib/plan/decide.h"

#include <algorithm>
#include <memory>
#include <optional>
#include <set>

#include "formats/error.h"
#include "formats/hash.h"
#include "lib/plan/stages.h"
#include "lib/render/choose_caustics.h"
#include "lib/render/choose_photons.h"
#include "lib/render/choose_split.h"
#include "lib/render/learn_lights.h"
#include "lib/render/seen_spheres.h"

namespace tempolux {
namespace {

constexpr std::size_t kMostEvents = 4, kMostViews = 16;
/// A state of light that follows from what stands needs what stands to be computed once: less than three states do not pay for it.
constexpr std::size_t kFewestStates = 3;
/// Frames from one key to the next that warping needs between them at least; with fewer each picture is a key or beside two.
constexpr std::size_t kFewestForKeys = 4;

bool shines_from_afar(const SceneFrame& frame) {
  return frame.environment || std::ranges::any_of(frame.lights, [](const PlacedLight& placed) {
           return placed.light.kind == PunctualLight::Kind::directional;
         });
}

CameraView view_at(const SceneFrame& frame, const SceneSource& source, const Wish& wish) {
  return CameraView(frame.camera(source.camera_node), frame.origin, wish.width, wish.height);
}

/// What one looked frame asks for.
struct Look {
  IndirectMethod method = IndirectMethod::records;
  bool caustic_map = false;      ///< with paths
  bool dark = false;             ///< surfaces scatter no light
  int rays = 0;
  std::uint64_t paths = 0;
  bool learn = false;
  std::string because;
};

class FramePilot {
 public:
  FramePilot(const Wish& wish, const SceneSource& source, int number, const std::string& kinds)
      : kinds_(kinds), wish_(wish), frame_(source.at(number, true)), table_(source.emission(frame_.frame)),
        view_(view_at(frame_, source, wish)), tracer_(frame_), lights_(frame_, table_) {}

  Look look(bool media) {
    Look look;
    const IndirectPilot pilot = pilot_indirect({tracer_, lights_}, view_, wish_.pixel_error, 0);
    look.dark = !(pilot.scattered > 0);
    look.rays = record_rays(pilot, wish_.rays);
    look.learn = lights_.has_distant() && pilot.open_share <= kMostOpen;
    if (wish_.indirect == "auto") choose_method(pilot, media, look);
    look.paths = wish_.photons;
    if (look.method != IndirectMethod::paths && lights_.has_distant())
      look.paths = photon_paths(pilot_arrivals({tracer_, aimed()}, kinds_, 0), wish_.photons);
    return look;
  }

  SplitChoice split() { return choose_split(pilot_split(frame_, table_, view_, 0)); }
  MovingPilot moving() { return pilot_moving(frame_, table_, view_, 0); }

 private:
  void choose_method(const IndirectPilot& pilot, bool media, Look& look) {
    const IndirectChoice choice = choose_indirect(pilot);
    look.method = choice.method;
    look.because = choice.because;
    if (choice.method != IndirectMethod::paths) return;
    if (media) {
      look.method = IndirectMethod::gather;
      look.because = "photons light the media, points read them, too";
    } else if (kinds_.find("caustic") != std::string::npos) {
      choose_beside_paths(pilot, look);
    }
  }

  /// Paths, beside a map of caustic photons if that pays, or what photons ask for if paths do not find what indirect light there is.
  void choose_beside_paths(const IndirectPilot& paths, Look& look) {
    const SeenPhotons caustic = see_photons({tracer_, aimed()}, view_, "caustic", 0);
    const CausticChoice map = choose_caustics(paths, caustic);
    look.caustic_map = map.map;
    look.because += "; " + map.because;
    if (!map.map) return;
    const IndirectChoice beside = choose_beside_caustics(paths, caustic, see_photons({tracer_, aimed()}, view_, "indirect", 0));
    if (beside.method == IndirectMethod::paths) return;
    look.method = beside.method;
    look.because = beside.because;
  }

  /// Lights that aim photons where the camera looks, as those of photon-trace.
  const Lights& aimed() {
    if (!aimed_) aimed_.emplace(aimed_lights(tracer_, table_, view_));
    return *aimed_;
  }

  std::string kinds_;
  const Wish& wish_;
  SceneFrame frame_;
  EmissionTable table_;
  CameraView view_;
  Tracer tracer_;
  Lights lights_;
  std::optional<Lights> aimed_;
};

std::string words(std::size_t count, const std::string& what) { return std::to_string(count) + " " + what + (count == 1 ? "" : "s"); }

std::string kinds_of(const MaterialFacts& materials, bool media) {
  std::string kinds = !materials.lambert ? "" : materials.other ? "caustic,indirect" : "indirect";
  if (media) kinds += kinds.empty() ? "volume" : ",volume";
  return kinds;
}

/// Joins what the looked frames ask for.
void join(const std::vector<std::pair<int, Look>>& looks, const Wish& wish, Decisions& d) {
  d.record_rays = 0;
  d.photon_paths = 0;
  d.indirect = IndirectMethod::paths;
  bool map = false, any = false;
  std::string because;
  for (const auto& [frame, look] : looks) {
    d.record_rays = std::max(d.record_rays, look.rays);
    d.photon_paths = std::max(d.photon_paths, look.paths);
    d.learn_lights |= look.learn;
    map |= look.caustic_map;
    if (look.dark && looks.size() > 1) continue;
    if (!any || look.method < d.indirect) {
      d.indirect = look.method;
      because = "frame " + std::to_string(frame) + ": " + look.because;
    }
    any = true;
  }
  if (!any) {
    d.indirect = looks.front().second.method;
    because = looks.front().second.because;
  }
  if (wish.indirect != "auto") {
    d.indirect = IndirectMethod(std::ranges::find(kIndirectMethods, wish.indirect) - std::begin(kIndirectMethods));
    because = "--indirect " + wish.indirect;
  }
  if (d.indirect == IndirectMethod::paths) d.kinds = map ? "caustic" : "";
  d.reasons.push_back({"irradcache-build records", because});
}

void decide_split(FramePilot& pilot, const Wish& wish, Decisions& d) {
  if (!d.points()) return;
  const SplitChoice choice = wish.split == "auto" ? pilot.split() : SplitChoice{wish.split == "on", "--split " + wish.split};
  if (wish.split == "on" && wish.moving == "records")
    throw InputError("--split on with --moving records: records that follow from those of what stands know no bright points; use --moving time or anew");
  d.split = choice.split && d.moving != MovingMethod::records;
  d.reasons.push_back({"photonmap-split", choice.split && !d.split ? "records follow from those of what stands" : choice.because});
}

MovingMethod moving_named(const std::string& name) {
  return MovingMethod(std::ranges::find(kMovingMethods, name) - std::begin(kMovingMethods));
}

/// What of a frame's light follows from that of what stands.
void decide_moving(const PlannedSegment& segment, const Wish& wish, bool media, const SceneSource& source, Decisions& d) {
  const std::string name = "photon-trace --map dynamic";
  const auto anew = [&](const std::string& because) { d.reasons.push_back({name, because}); };
  const std::vector<int> states = segment.states();
  if (!d.points() || states.size() < kFewestStates) return anew(words(states.size(), "state") + " of light in the segment");
  if (media && wish.moving != "auto" && wish.moving != "anew")
    throw InputError("--moving " + wish.moving + ": the scene has media, which all light meets: what movers change of it cannot be told apart; use --moving anew");
  if (media) return anew("there are media, which all light meets");
  if (wish.moving == "anew") return anew("--moving anew");
  FramePilot pilot(wish, source, states[states.size() / 2], d.kinds);
  MovingChoice choice = choose_moving(pilot.moving(), 1, states.size());
  if (wish.moving != "auto") choice = {moving_named(wish.moving), choice.cost, "--moving " + wish.moving};
  d.moving = choice.method;
  if (d.moving > MovingMethod::light && !d.records()) d.moving = MovingMethod::light;
  d.moving_cost = choice.cost;
  if (d.moving == MovingMethod::time) d.moving_cost.records = records_over_time(1, states.size());
  d.reasons.push_back({name, choice.because});
}

/// Are there pictures between key frames that warping could make?
void decide_walk(const PlannedSegment& segment, Decisions& d) {
  const std::size_t pictures = segment.pictures().size(), states = segment.states().size();
  std::string because;
  if (pictures < kFewestForKeys) because = words(pictures, "different picture") + ": too few to lie between keys";
  else if (pictures == states) because = "light transport differs in all " + words(pictures, "picture") + ": keys lend little light to others";
  else because = "the camera moves through " + words(pictures, "picture") + " of " + words(states, "state") + " of light; " + segment.materials.other_words;
  d.walk = pictures >= kFewestForKeys && pictures > states;
  d.reasons.push_back({"ibr-warp", because});
}

}  // namespace

std::vector<int> looked_frames(const PlannedSegment& segment) {
  std::set<int> looked{segment.first, segment.first + (segment.last - segment.first) / 2, segment.last};
  std::size_t events = 0;
  for (std::size_t i = 1; i < segment.frames.size() && events < kMostEvents; ++i) {
    const auto light = [&](std::size_t k) { return segment.frames[k].light; };
    if (light(i) == light(i - 1)) continue;
    const bool stood = i >= 2 && light(i - 1) == light(i - 2), stays = i + 1 < segment.frames.size() && light(i) == light(i + 1);
    if (!stood && !stays) continue;   // something moves on
    events += looked.insert(segment.frames[i].frame).second;
  }
  std::set<int> pictures;
  std::vector<int> frames;
  for (const int frame : looked)
    if (pictures.insert(segment.at(frame).picture).second) frames.push_back(frame);
  return frames;
}

std::string view_of(const PlannedSegment& segment, int width, int height, const SceneSource& source) {
  const std::vector<int> pictures = segment.pictures();
  const std::size_t count = std::min(kMostViews, pictures.size());
  StandingTree standing;
  std::vector<WeighedPlace> places;
  double radius = 0;
  bool from_afar = false;
  for (std::size_t i = 0; i < count; ++i) {
    const SceneFrame frame = source.at(pictures[i * pictures.size() / count], false);
    from_afar = from_afar || shines_from_afar(frame);
    radius = std::max(radius, source.emission(frame.frame).sphere_radius);
    const Tracer tracer(frame, standing);
    add_seen_places(tracer, CameraView(frame.camera(source.camera_node), frame.origin, width, height), i, places);
    // Under lamps alone photons are not aimed, and in a room points are spread everywhere: one look is enough.
    if (i == 0 && !from_afar && spheres_around(places, radius).empty()) return "";
  }
  const std::vector<formats::ViewSphere> spheres = spheres_around(places, radius);
  return spheres.empty() ? "" : formats::view_text(spheres);
}

Decisions decide(const PlannedSegment& segment, const Wish& wish, bool media, const SceneSource& source) {
  Decisions d;
  d.looked = looked_frames(segment);
  d.kinds = kinds_of(segment.materials, media);
  d.reasons.push_back({"photon-trace", segment.materials.lambert ? segment.materials.lambert_words : "nothing reflects by a Lambert lobe"});
  if (d.photons()) {
    if (wish.indirect == "paths" && media)
      throw InputError("--indirect paths: the scene has media, which photons light; choose records or gather");
    std::vector<std::pair<int, Look>> looks;
    std::unique_ptr<FramePilot> middle;
    for (const int frame : d.looked) {
      auto pilot = std::make_unique<FramePilot>(wish, source, frame, d.kinds);
      looks.emplace_back(frame, pilot->look(media));
      if (looks.size() == (d.looked.size() + 1) / 2) middle = std::move(pilot);
    }
    join(looks, wish, d);
    decide_moving(segment, wish, media, source, d);
    decide_split(*middle, wish, d);
    if (d.photons()) d.view = view_of(segment, wish.width, wish.height, source);
  }
  decide_walk(segment, d);
  return d;
}

std::string decision_key(const PlannedSegment& segment, const Wish& wish, bool media) {
  Hasher hasher;
  for (const PlannedFrame& frame : segment.frames) {
    hasher.add(std::string_view(frame.light));
    hasher.add(std::string_view(frame.camera));
  }
  hasher.add(std::string_view(segment.standing));
  for (const std::string& word : {wish.indirect, wish.moving, wish.split, wish.common}) hasher.add(std::string_view(word));
  for (const double number : {double(wish.width), double(wish.height), double(wish.photons), double(wish.rays), wish.pixel_error, double(media)})
    hasher.add(number);
  return hasher.hex();
}

}  // namespace tempolux
