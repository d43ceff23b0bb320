#include "lib/gather/world_records.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <tuple>
#include <unordered_map>

#include "lib/core/parallel_each.h"
#include "lib/material/surface_material.h"
#include "lib/transport/shading.h"

namespace tempolux {
namespace {

/// Largest radius [m] of a record of a class: the spacing of the next wider class. A record need not reach farther,
/// because a gap that wider classes left is narrower than that.
float most_radius(int spacing_class) { return spacing_of(spacing_class + 1); }
/// Places of class c are tested against wanted places thinned out to class c - kFiner, so that thinning loses little.
constexpr int kFiner = 3;
/// Least cosine between the normal of a wanted place, which normal maps bend, and the normal of a surface near it.
constexpr float kMayBend = 0.3f;
/// Changes the seed of the second gather of a record that is gathered twice.
constexpr std::uint64_t kSecondGather = 0x616761696eull;
constexpr std::uint64_t kCheckedOneIn = 32;  ///< one record in this many is gathered twice

float footprint_of(int level) { return std::ldexp(1.0f, level); }

/// Slack [m] for the distance between a seen point and the point that thin_out() kept for its cell: about the mean
/// distance. A point farther away misses only the border of a record's disc, where its weight is low.
float apart_in(int spacing_class) { return 0.5f * spacing_of(spacing_class); }

/// Number of pixels of a record's disc.
double pixels_of(const IrradianceRecord& record, float footprint) {
  const double radius = double(record.radius) / double(footprint);
  return kPi * radius * radius;
}

/// Adds the variance and the noise of a record that was gathered twice to `counts`. Both are weighted as a viewer sees
/// errors, by the squared slope of the sRGB curve, which is proportional to level^(-7/6), and by `pixels`, the part of
/// the picture that the record lights. Errors of gradients do not count: with them, at the mean distance of
/// interpolation, the estimated noise of a hut's picture was 1.12 times the difference of two seeds, and 1.02 times
/// without them.
void count_twice(const IrradianceRecord& once, const IrradianceRecord& again, double pixels, GatherCounts& counts) {
  const Rgbd a(once.irradiance), b(again.irradiance), n(once.noise), m(again.noise);
  const double level = channel_mean(a + b);
  if (!(level > 0)) return;
  const double seen = pixels * std::pow(level, -7.0 / 6) / 2;
  counts.twice_variance += seen * channel_mean((a - b) * (a - b));
  counts.twice_noise += seen * channel_mean(n * n + m * m);
}

/// A record without light. A RecordStore of these answers which places lie within `radius` on the same surface.
IrradianceRecord disc(Vec3 position, Vec3 normal, float radius) {
  IrradianceRecord record;
  record.position = position;
  record.normal = normal;
  record.radius = radius;
  return record;
}

std::vector<WantedPlace> places_of(std::span<const WantedPoint> wanted) {
  std::vector<WantedPlace> places;
  for (const WantedPoint& at : wanted) places.push_back(at.place);
  return places;
}

WantedPoint wanted(const SeenPoint& seen, int frame, std::size_t pixel, std::uint32_t look) {
  const float level = std::clamp(std::round(std::log2(seen.footprint)), -60.0f, 60.0f);
  return {{seen.surface.position, seen.normal}, int(level), frame, std::uint32_t(pixel), look};
}

}  // namespace

std::vector<WantedPoint> wanted_points(const PixelView& view, int frame, int width, int height) {
  const std::size_t pixels = std::size_t(width) * std::size_t(height);
  std::vector<Glimpse> glimpses(pixels);
  using Found = std::vector<WantedPoint>;
  Found all = parallel_found<WantedPoint>(pixels, 1024, [&](std::size_t p, Found& found) {
    const std::optional<SeenPoint> seen = view(centre_look(p, width));
    if (!seen) return;
    glimpses[p] = Glimpse(*seen);
    found.push_back(wanted(*seen, frame, p, 0));
  });
  const std::vector<std::size_t> edges = edge_pixels(glimpses, width, height);
  const Found more = parallel_found<WantedPoint>(edges.size() * kEdgeLooks, 1024, [&](std::size_t i, Found& found) {
    const std::size_t pixel = edges[i / kEdgeLooks];
    const auto k = std::uint32_t(i % kEdgeLooks);
    if (const auto seen = view(edge_look(pixel, width, k))) found.push_back(wanted(*seen, frame, pixel, k + 1));
  });
  all.insert(all.end(), more.begin(), more.end());
  return all;
}

WorldRecords::WorldRecords(const FinalGather& gather, const Tracer& tracer, const PlacementOptions& options)
    : gather_(gather),
      tracer_(tracer),
      options_(options),
      widest_(int(std::lround(2 * std::log2(2 * options.unseen_radius_px)))),
      narrowest_(int(std::lround(2 * std::log2(options.min_radius_px))) - 1),
      moving_(tracer.frame()) {}

void WorldRecords::want(std::span<const WantedPoint> wanted) {
  for (const WantedPoint& at : wanted) levels_[at.level].wanted[0].push_back(at);
  for (auto& [number, level] : levels_) thin_out(tracer_, 2 * number, level.wanted[0]);
}

PlacementOptions WorldRecords::limited(float most_radius) const {
  PlacementOptions options = options_;
  options.max_radius = most_radius;
  return options;
}

std::optional<WorldRecords::Member> WorldRecords::member_at(const WorldPlace& place, int level, int spacing_class,
                                                            const RecordStore& placed, GatherCounts& counts) const {
  Member member{place.key, {place.surface, {}, footprint_of(level)}, {}, 0, most_radius(spacing_class)};
  SeenPoint& seen = member.seen;
  if (moving_.contains(seen.surface.object)) return std::nullopt;
  const SurfaceMaterial material(tracer_.frame(), seen.surface, seen.footprint);
  const ShadingPoint shading(seen.surface, place.normal, material);
  if (!shading.bsdf.has_diffuse()) return std::nullopt;
  seen.normal = shading.normal;
  if (placed.covers(seen.surface.position, seen.normal, options_.min_weight)) return std::nullopt;
  IrradianceRecord& record = member.record;
  record.position = seen.surface.position;
  record.normal = seen.normal;
  record.object = seen.surface.object;
  record.radius_unclamped = member.range = gather_.distance(seen.surface, seen.normal, counts);
  // A place whose surroundings are closer than a pixel lies in a crack: dark and mostly hidden. Its record has a radius
  // of at least 4 pixels, so it would darken the visible surface beside the crack.
  if (member.range < seen.footprint) return std::nullopt;
  limit_radius(record, seen.footprint, limited(member.most_radius));
  gather_.look_around(seen.surface, record);
  return member;
}

void WorldRecords::choose(GatherCounts& counts) {
  for (auto& [number, level] : levels_) choose_in_level(number, level, counts);
}

void WorldRecords::choose_in_level(int number, Level& level, GatherCounts& counts) const {
  for (int c = 1; c <= widest_; ++c) {
    level.wanted.push_back(level.wanted.back());
    thin_out(tracer_, 2 * number + c, level.wanted.back());
  }
  for (int c = widest_; c >= narrowest_; --c) {
    const int spacing_class = 2 * number + c;
    const float radius = std::max(options_.min_radius_px * footprint_of(number), most_radius(spacing_class)),
                slack = apart_in(spacing_class - kFiner);
    RecordStore reached(kMayBend);  // discs around wanted places
    for (const WantedPoint& at : level.wanted[std::size_t(std::max(0, c - kFiner))])
      reached.add(disc(at.place.position, at.place.normal, radius + slack));
    const std::vector<WorldPlace> places =
        world_places(tracer_, spacing_class, radius, places_of(level.wanted[std::size_t(c)]));
    std::vector<std::optional<Member>> found(places.size());
    counts += parallel_sum<GatherCounts>(places.size(), 8, [&](std::size_t i, GatherCounts& local) {
      if (reached.covers(places[i].surface.position, face_forward(places[i].surface.normal, places[i].normal), 1e-6f))
        found[i] = member_at(places[i], number, spacing_class, level.placed, local);
    });
    for (std::optional<Member>& member : found)
      if (member && level.placed.add(member->record)) level.members.push_back(*std::move(member));
  }
}

/// One element per member: 1 if the member's record may be valid at a wanted place.
std::vector<std::uint8_t> WorldRecords::needed(int number, const Level& level) const {
  RecordStore discs;
  for (const Member& member : level.members)
    discs.add(disc(member.record.position, member.record.normal, member.record.radius + apart_in(2 * number)));
  std::vector<std::uint8_t> needed(level.members.size());
  parallel_each(level.wanted[0].size(), 1024, [&](std::size_t i) {
    const WantedPlace& at = level.wanted[0][i].place;
    discs.for_each_valid(at.position, at.normal, [&](std::uint32_t member) {
      std::atomic_ref(needed[member]).store(1, std::memory_order_relaxed);
    });
  });
  return needed;
}

IrradianceRecord WorldRecords::gathered(const FinalGather& gather, const Member& member, const RayShare& share,
                                        GatherCounts& counts) const {
  const SeenPoint& seen = member.seen;
  IrradianceRecord record = gather.light(seen.surface, seen.normal, counts, share ? share(seen) : 1.0f);
  record.radius_unclamped = member.range;
  limit_radius(record, seen.footprint, limited(member.most_radius));
  record.clearance = member.record.clearance;
  return record;
}

void WorldRecords::gather(const RayShare& share, RecordStore& store, GatherCounts& counts) const {
  std::vector<const Member*> chosen;
  std::unordered_map<std::uint64_t, std::size_t> by_key;
  for (const auto& [number, level] : levels_) {
    const std::vector<std::uint8_t> marked = needed(number, level);
    for (std::size_t i = 0; i < level.members.size(); ++i) {
      if (!marked[i]) continue;
      const Member& member = level.members[i];
      const auto [known, is_new] = by_key.try_emplace(member.key, chosen.size());
      if (is_new) chosen.push_back(&member);
      else if (member.record.radius > chosen[known->second]->record.radius) chosen[known->second] = &member;
    }
  }
  const std::size_t before = store.records().size();
  const FinalGather second = gather_.with_seed(gather_.seed() ^ kSecondGather);
  std::vector<IrradianceRecord> records(chosen.size());
  counts += parallel_sum<GatherCounts>(chosen.size(), 8, [&](std::size_t i, GatherCounts& local) {
    const Member& member = *chosen[i];
    records[i] = gathered(gather_, member, share, local);
    if (mix64(member.key) % kCheckedOneIn == 0)
      count_twice(records[i], gathered(second, member, share, local), pixels_of(records[i], member.seen.footprint),
                  local);
  });
  for (const IrradianceRecord& record : records) store.add(record);
  store.complete_noise(before, noise_factor(counts));
}

std::vector<WantedPoint> WorldRecords::gaps(const RecordStore& store, float weight) const {
  std::vector<WantedPoint> open;
  for (const auto& entry : levels_) {
    const std::vector<WantedPoint>& wanted = entry.second.wanted[0];
    const auto found = parallel_found<WantedPoint>(wanted.size(), 1024, [&](std::size_t i, auto& some) {
      if (!store.covers(wanted[i].place.position, wanted[i].place.normal, weight)) some.push_back(wanted[i]);
    });
    open.insert(open.end(), found.begin(), found.end());
  }
  std::ranges::sort(open, {}, [](const WantedPoint& at) { return std::tuple(at.frame, mix64(at.pixel), at.look); });
  return open;
}

}  // namespace tempolux
