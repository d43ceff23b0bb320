#include "lib/plan/looks.h"

#include <algorithm>
#include <cmath>

namespace tempolux {
namespace {

/// A segment departs from the shot's way to light if the shot's way needs more than this many times the work of the
/// segment's best way; departs() allows for the pilots' error besides.
constexpr double kDeparture = 1.3;

/// True if the user and the scene allow this way to light. Media exclude paths, because photons light media.
bool is_allowed(const Way& way, const Wish& wish, bool media) {
  return !(media && way.method == IndirectMethod::paths) &&
         (wish.indirect == "auto" || kIndirectMethods[std::size_t(way.method)] == wish.indirect);
}

/// The way with a method and a source of caustic light; null if it is not there, as in a frame that sees no Lambert
/// lobe.
const Way* find_way(const std::vector<Way>& ways, IndirectMethod method, bool map) {
  const auto found = std::ranges::find_if(ways, [&](const Way& way) { return way.method == method && way.map == map; });
  return found == ways.end() ? nullptr : &*found;
}

/// Score of the shot's way over the score of the segment's best way above which the segment departs from the shot's
/// way. error: standard error of the logarithm of this ratio.
double departure(double error) { return kDeparture * std::exp(2 * error); }
/// Standard error that is assumed if only one frame was measured: then its spread over frames is not known.
const double kErrorOfOne = std::log(kDeparture);

}  // namespace

std::vector<Way> joined_ways(const std::vector<FrameWays>& looks) {
  std::vector<std::vector<Way>> of_frames;
  for (const FrameWays& look : looks) of_frames.push_back(look.ways);
  return joined(of_frames);
}

std::optional<Way> best_of(const std::vector<Way>& ways, const Wish& wish, bool media) {
  const auto best = std::ranges::find_if(ways, [&](const Way& way) { return is_allowed(way, wish, media); });
  return best == ways.end() ? std::nullopt : std::optional(*best);
}

namespace {

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

}  // namespace

std::vector<FrameWays> look_at(const Looking& looking, std::unique_ptr<FramePilot>& middle, LightSharing& sharing) {
  const auto& [frames, wish, media, pilot_of, sharing_of, shot] = looking;
  const int places = (kPilotPlaces + int(frames.size()) - 1) / int(frames.size());
  std::vector<FrameWays> looks;
  for (const int frame : frames) {
    std::unique_ptr<FramePilot> pilot = pilot_of(frame);
    if (looks.empty()) sharing = sharing_of(*pilot);
    looks.push_back(pilot->look(places, sharing, [&](const FrameWays& look) {
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
    looks[i] =
        pilot_of(frames[i])->look(places, sharing, [&](const FrameWays& look) { return look.knows(best->method); });
    i = std::size_t(-1);  // the best way may have changed
  }
  return looks;
}

bool departs(const std::vector<FrameWays>& looks, const Wish& wish, bool media, const Decisions& shot) {
  const std::vector<Way> ways = joined_ways(looks);
  const std::optional<Way> best = best_of(ways, wish, media);
  if (!best) return false;
  const Way* const of_shot = find_way(ways, shot.indirect, shot.caustic_map);
  if (!of_shot || !is_allowed(*of_shot, wish, media)) return true;
  if (of_shot->never > best->never || of_shot->uncertain > best->uncertain) return true;
  // Mean and standard error of log(score of the shot's way / score of the best way) over the frames.
  double n = 0, sum = 0, squares = 0;
  for (const FrameWays& look : looks) {
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

}  // namespace tempolux
