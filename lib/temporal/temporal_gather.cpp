#include "lib/temporal/temporal_gather.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <mutex>

#include "lib/core/check.h"
#include "lib/core/parallel.h"
#include "lib/core/statistics.h"
#include "lib/gather/cache_files.h"
#include "lib/scene/deform.h"
#include "lib/scene/moving_objects.h"
#include "lib/temporal/light_changes.h"

namespace tempolux {
namespace {

constexpr int kFadingFrames = 4;             ///< frames over which a superfluous record fades out (radsamples.md)
constexpr float kLeastOfHidden = 1.0f / 64;  ///< radius of a hidden record over the smallest radius; must be above 0
constexpr std::uint32_t kAhead = 12;         ///< number of cells ahead whose light is prefetched into the cache
/// Share of TemporalOptions::refresh that is drawn by age, however many cells are traced for other reasons.
constexpr auto kLeastAged = float(kUnguidedShare);

/// Unit vectors along a triangle's first edge, across it in its plane, and along its normal.
std::array<Vec3, 3> edges_of(const Surface& surface, std::uint32_t triangle) {
  const auto& t = surface.primitive->triangles[triangle];
  const Vec3 a = surface.position(t[0]), along = normalize(surface.position(t[1]) - a);
  const Vec3 normal = normalize(cross(surface.position(t[1]) - a, surface.position(t[2]) - a));
  return {along, cross(normal, along), normal};
}

/// True if the record's triangle has an area at both frames. A surface that is scaled to nothing has no room for
/// records.
bool stays(const SceneFrame& before, const SceneFrame& now, const formats::RadsamplesRecord& r) {
  for (const SceneFrame* frame : {&before, &now})
    for (const Vec3 edge : edges_of(frame->surfaces[r.surface], r.triangle))
      if (!(length2(edge) > 0.5f)) return false;  // 1, or NaN
  return true;
}

bool deforms(const SceneFrame& frame, std::uint32_t surface) {
  return frame.scene && deforms(*frame.scene, frame.scene->nodes[frame.surfaces[surface].node]);
}

void add(const TemporalCounts& from, TemporalCounts& to) {
  to.moved += from.moved, to.lost += from.lost, to.unanchored += from.unanchored, to.near += from.near,
      to.aged += from.aged;
  to.scaled += from.scaled, to.explicit_only += from.explicit_only;
  to.update += from.update;
}

}  // namespace

struct TemporalGather::Marked {
  std::vector<std::uint8_t> marks;  ///< by cell; emptied once the record needs no update
  std::size_t count = 0;            ///< number of cells that are traced
  bool changed = false;
};

std::size_t anchored_points(const SceneFrame& frame, std::span<const IrradiancePoint> points) {
  const MovingObjects moving(frame);
  std::size_t count = 0;
  while (count < points.size() && !moving.contains(points[count].object)) ++count;
  return count;
}

TemporalGather::TemporalGather(const TemporalScene& scene, const GatherOptions& gather,
                               const PlacementOptions& placement, const TemporalOptions& options, float diagonal)
    : scene_(scene),
      gather_options_(gather),
      placement_(placement),
      options_(options),
      units_{diagonal},
      gather_(scene.tracer, scene.lights, scene.lookup, gather),
      strata_(gather.rays) {}

SurfacePoint TemporalGather::place_of(const KeptHemisphere& kept) const {
  const auto& r = kept.record;
  return scene_.tracer.surface_point({0, r.surface, r.triangle, r.barycentric[0], r.barycentric[1]});
}

/// Moves a record with its triangle.
void TemporalGather::move_with_surface(KeptHemisphere& kept) const {
  formats::RadsamplesRecord& r = kept.record;
  const auto before = edges_of(scene_.before->surfaces[r.surface], r.triangle);
  const auto now = edges_of(scene_.tracer.frame().surfaces[r.surface], r.triangle);
  const Vec3 normal = kept.normal();
  Vec3 turned{};
  for (std::size_t axis = 0; axis < 3; ++axis) turned = turned + now[axis] * dot(before[axis], normal);
  turned = normalize(turned);
  r.position = array_of(place_of(kept).position);
  if (length2(turned) > 0) r.normal = array_of(turned);
}

/// Traces the marked cells. The direction of a cell's ray follows from its age (KeptHemisphere::draw_of).
void TemporalGather::trace_cells(const SurfacePoint& place, KeptHemisphere& kept, const GatherDirections& directions,
                                 std::span<const std::uint8_t> marks, GatherCounts& counts) const {
  thread_local GatherRays shot;
  shot.clear();
  const GatherStrata strata(kept.record.rings, kept.record.sectors);
  for (const std::uint32_t c : strata.order) {
    if (!is_traced(marks[c]) || shot.aim(directions, c, kept.draw_of(c))) continue;
    kept.samples[c] = {{}, 0, formats::age_of(kept.samples[c])};
    kept.anchors[c] = kNone;
  }
  gather_.follow(place, kept.normal(), shot, counts);
  for (std::size_t i = 0; i < shot.rays.size(); ++i) {
    RadianceSource& source = shot.sources[i];
    const bool bright = is_bright(scene_, source.point);
    source.partial |= bright;
    const bool may_anchor = source.point < scene_.anchored_points && !bright;
    keep_ray(kept, shot.cells[i], {shot.radiance[i], shot.distance[i], source, may_anchor}, units_);
  }
}

/// True if a mover has come so close that the record would get the smallest radius, which covers the pixels around it,
/// and the camera does not see the record. Example: a lamp glides along a ceiling. A record behind the lamp is dark;
/// with the smallest radius it would darken the visible ceiling around the lamp.
bool TemporalGather::is_hidden(const SurfacePoint& place, const formats::RadsamplesRecord& before,
                               const IrradianceRecord& made) const {
  const float smallest = placement_.min_radius_px * before.footprint;
  const bool had_its_own = std::abs(before.radius - smallest) > 1e-4f * smallest;
  if (!scene_.eye || !had_its_own || radius_of(made, before.footprint, placement_) > smallest) return false;
  const std::optional<Vec3> eye = scene_.eye(place.position);
  return !eye || scene_.tracer.occluded(spawn_shadow_ray(place, *eye, 0));
}

/// Computes the record from its samples. `changes`: nullptr for a new record. If something has moved within the
/// record's mean distance, the mean distance is measured again.
void TemporalGather::finish(const SurfacePoint& place, KeptHemisphere& kept, const LightChanges* changes,
                            GatherCounts& counts) const {
  const bool born = !changes;
  IrradianceRecord made = reconstruct(kept, place, units_);
  made.radius_unclamped = kept.record.radius_unclamped / placement_.error_bound;
  if (born || near_a_mover(kept, *changes, made.radius_unclamped))
    made.radius_unclamped = gather_.distance(place, kept.normal(), counts);
  gather_.add_explicit(place, kept.record.key, made, counts);
  PlacementOptions placement = placement_;
  if (!born && is_hidden(place, kept.record, made)) placement.min_radius_px *= kLeastOfHidden;
  limit_radius(made, kept.record.footprint, placement);
  made.clearance = stored_values(kept.record).clearance;
  const bool look_again = born || near_a_mover(kept, *changes, kept.record.clearance_reach);
  if (look_again || made.radius * Clearance::kPerRadius > made.clearance.reach) gather_.look_around(place, made);
  store_values(made, kept.record);
}

KeptHemisphere TemporalGather::birth(const SeenPoint& seen, GatherCounts& counts) const {
  KeptHemisphere kept;
  formats::RadsamplesRecord& r = kept.record;
  const SurfacePoint& place = seen.surface;
  r.position = array_of(place.position);
  r.normal = array_of(seen.normal);
  r.key = place_key(place.position, seen.normal, gather_options_.seed);
  r.surface = place.surface;
  r.triangle = place.triangle;
  r.barycentric = {place.u, place.v};
  r.set = place.surface < scene_.tracer.frame().static_count ? formats::SurfaceSet::static_set
                                                             : formats::SurfaceSet::dynamic_set;
  r.footprint = seen.footprint;
  r.rings = std::uint16_t(strata_.rings);
  r.sectors = std::uint16_t(strata_.sectors);
  kept.samples.resize(strata_.cells());
  kept.anchors.assign(strata_.cells(), kNone);
  const std::vector<std::uint8_t> marks(strata_.cells(), all);
  trace_cells(place, kept, GatherDirections(place, seen.normal, r.rings, r.sectors, r.key), marks, counts);
  finish(place, kept, nullptr, counts);
  return kept;
}

/// Moves a record with its surface and marks its cells. False if its light has not changed.
bool TemporalGather::mark(KeptHemisphere& kept, const LightChanges& changes, Marked& marked) const {
  if (kept.record.set == formats::SurfaceSet::dynamic_set) move_with_surface(kept);
  const SurfacePoint place = place_of(kept);
  const GatherDirections directions(place, kept.normal(), kept.record.rings, kept.record.sectors, kept.record.key);
  marked.changed = mark_cells(kept, changes, directions, units_, marked.marks);
  marked.count = std::size_t(std::count_if(marked.marks.begin(), marked.marks.end(), is_traced));
  return marked.changed;
}

void TemporalGather::update(KeptHemisphere& kept, const LightChanges& changes, double aged_share, Marked& marked,
                            TemporalCounts& counts) const {
  thread_local std::vector<std::uint16_t> ages;
  thread_local std::vector<std::uint32_t> drawn;
  formats::RadsamplesRecord& r = kept.record;
  std::vector<std::uint8_t>& marks = marked.marks;
  const SurfacePoint place = place_of(kept);
  const GatherDirections directions(place, kept.normal(), r.rings, r.sectors, r.key);
  ++r.updates;
  ages.resize(marks.size());
  for (std::size_t c = 0; c < marks.size(); ++c) {
    ages[c] = formats::age_of(kept.samples[c]);
    kept.samples[c].flags = std::uint16_t(kept.samples[c].flags + (ages[c] < formats::kMaxAge));
  }
  // Draws by age from all cells, including marked cells. If marked cells were left out, a cell that is marked in every
  // frame would keep its direction for ever, and more and more cells would get stuck in such directions.
  draw_by_age(ages, std::size_t(std::ceil(aged_share * double(marks.size() - marked.count))), mix64(r.key + r.updates),
              drawn);
  for (const std::uint32_t c : drawn) {
    marks[c] = aged;
    kept.samples[c].flags = std::uint16_t((kept.samples[c].flags & ~formats::kMaxAge) | 1);
  }
  std::array<std::size_t, all + 1> numbers{};
  for (const std::uint8_t mark : marks) ++numbers[mark];
  counts.scaled += numbers[scaled], counts.moved += numbers[moved], counts.lost += numbers[lost];
  counts.unanchored += numbers[unanchored], counts.near += numbers[near], counts.aged += numbers[aged];
  for (std::uint32_t c = 0; c < marks.size(); ++c) {
    const std::uint32_t ahead = std::min<std::uint32_t>(c + kAhead, std::uint32_t(marks.size()) - 1);
    if (marks[ahead] == scaled) __builtin_prefetch(&changes.ratios[kept.anchors[ahead]]);
    if (marks[c] == scaled) scale_radiance(kept, c, changes.ratios[kept.anchors[c]]);
  }
  trace_cells(place, kept, directions, marks, counts.update);
  finish(place, kept, &changes, counts.update);
}

/// Marks the cells of all records, then updates the records that change. Two passes are needed because the number of
/// cells that are drawn by age depends on the number of cells that are traced for other reasons.
void TemporalGather::update_all(KeptHemispheres& kept, const LightChanges& changes, const std::vector<bool>& gone,
                                TemporalCounts& counts) const {
  std::vector<Marked> marked(kept.records.size());
  std::mutex mutex;
  std::size_t traced = 0, others = 0;
  parallel_chunks(marked.size(), 16, [&](std::size_t first, std::size_t last) {
    std::size_t here = 0, all = 0, unmoved = 0, cells = 0;
    for (std::size_t i = first; i < last; ++i) {
      if (gone[i]) continue;
      KeptHemisphere& k = kept.records[i];
      cells += k.record.samples();
      if (mark(k, changes, marked[i])) {
        here += marked[i].count;
        all += k.record.samples();
      } else {
        ++unmoved;
      }
      if (!marked[i].changed) std::vector<std::uint8_t>().swap(marked[i].marks);
    }
    const std::lock_guard lock(mutex);
    counts.cells += cells, (changes.divided ? counts.explicit_only : counts.kept) += unmoved, traced += here,
        others += all - here;
  });
  const double refresh = double(options_.refresh), cells = double(traced + others);
  const double to_fill = others > 0 ? (refresh * cells - double(traced)) / double(others) : 0;
  const double aged_share = std::max(to_fill, refresh * double(kLeastAged));
  parallel_chunks(marked.size(), 16, [&](std::size_t first, std::size_t last) {
    TemporalCounts local;
    for (std::size_t i = first; i < last; ++i) {
      if (gone[i] || !(marked[i].changed || changes.divided)) continue;
      KeptHemisphere& k = kept.records[i];
      if (marked[i].changed) update(k, changes, aged_share, marked[i], local);
      else finish(place_of(k), k, &changes, local.update);  // Samples the bright points anew.
      std::vector<std::uint8_t>().swap(marked[i].marks);
    }
    const std::lock_guard lock(mutex);
    add(local, counts);
  });
}

void TemporalGather::advance(KeptHemispheres& kept, TemporalCounts& counts) const {
  const SceneFrame& now = scene_.tracer.frame();
  const std::size_t before = kept.records.size();
  std::vector<bool> gone(before);
  for (std::size_t i = 0; i < before; ++i) {
    const formats::RadsamplesRecord& r = kept.records[i].record;
    if (r.set != formats::SurfaceSet::dynamic_set) continue;
    const bool lost_place = !stays(*scene_.before, now, r);
    gone[i] = deforms(now, r.surface) || lost_place;
    counts.deforming += gone[i] && !lost_place;
    counts.removed += lost_place;
  }
  const LightChanges changes = light_changes(scene_, kept, gather_options_.bright != nullptr);
  if (changes.anything) {
    update_all(kept, changes, gone, counts);
    for (std::size_t i = 0; i < before; ++i) {
      std::uint8_t& fading = kept.records[i].record.fading;
      if (gone[i] || fading == 0) continue;
      fading = std::uint8_t((fading + 1) % kFadingFrames);
      if (fading == 0) gone[i] = true, ++counts.removed;
    }
  } else {
    for (const KeptHemisphere& k : kept.records) counts.cells += k.record.samples();
    counts.kept += before;
  }
  // New number of each record after others were removed.
  std::vector<std::uint32_t> moved_to(before + 1, 0);
  for (std::size_t i = 0; i < before; ++i) moved_to[i + 1] = moved_to[i] + !gone[i];
  for (std::size_t i = 0; i < before; ++i)
    if (!gone[i] && moved_to[i] != i) kept.records[moved_to[i]] = std::move(kept.records[i]);
  kept.records.resize(moved_to[before]);
  kept.changed = changes.anything;
  kept.point_light.clear();
}

/// Fills the store with the kept records. A record begins to fade if other records cover its place in the meantime: if
/// the sum of the weights of all earlier records that do not fade is larger by 1 than it was when the record was
/// placed.
void TemporalGather::fill(KeptHemispheres& kept, RecordStore& store) const {
  for (const KeptHemisphere& k : kept.records) {
    IrradianceRecord record = stored_values(k.record);
    record.radius = std::max(record.radius * float(kFadingFrames - k.record.fading) / kFadingFrames,
                             std::numeric_limits<float>::min());
    TEMPOLUX_CHECK(store.add(record));
  }
  if (!kept.changed) return;
  std::vector<std::uint8_t> fades(kept.records.size());
  for (std::uint32_t i = 0; i < kept.records.size(); ++i) {
    std::uint8_t& fading = kept.records[i].record.fading;
    const bool begins = fading == 0 && store.weight_of_earlier(i, fades) >= 1 + kept.records[i].record.birth_weight;
    if (begins) fading = 1;
    fades[i] = fading > 0;
    if (begins) store.shrink(i, store.records()[i].radius * float(kFadingFrames - 1) / kFadingFrames);
  }
}

void TemporalGather::place(RecordPicture picture, KeptHemispheres& kept, RecordStore& store,
                           TemporalCounts& counts) const {
  fill(kept, store);
  std::vector<KeptHemisphere> batch(kPlacedTogether);
  RecordSource source;
  source.gather = [&](const SeenPoint& seen, std::size_t slot, GatherCounts& gathered) {
    batch[slot] = birth(seen, gathered);
    return stored_values(batch[slot].record);
  };
  source.added = [&](std::size_t slot) {
    batch[slot].record.birth_weight = store.weight_of_earlier(std::uint32_t(store.records().size() - 1), {});
    kept.records.push_back(std::move(batch[slot]));
    batch[slot] = {};
  };
  picture.source = &source;
  counts.born += place_records(gather_, picture, placement_, store, counts.birth);
  counts.records = kept.records.size();
  for (std::size_t i = 0; i < scene_.anchored_points; ++i) kept.point_light.push_back(scene_.points[i].total());
  kept.high_hash = scene_.high_hash;
  for (const KeptHemisphere& k : kept.records)
    for (const formats::RadianceSample& sample : k.samples) {
      const std::size_t age = formats::age_of(sample);
      if (age >= counts.ages.size()) counts.ages.resize(age + 1);
      ++counts.ages[age];
    }
}

}  // namespace tempolux
