#include "lib/temporal/light_changes.h"

#include <algorithm>
#include <cmath>

#include "lib/core/check.h"
#include "lib/core/random.h"

namespace tempolux {
namespace {

/// Each close hit is traced again once in this number of updates (table in docs/notebook/temporal.md).
constexpr std::uint64_t kTurns = 8;
/// If the light of an anchor changes by more than this factor, up or down, its cells are traced again instead of
/// scaled. Few cells meet this limit: 0, 0 and .1 % of them in the three sequences of docs/notebook/temporal.md.
constexpr float kLargestRatio = 2;

Box3 grown(const Box3& box, float by) { return {box.lower - Vec3{by, by, by}, box.upper + Vec3{by, by, by}}; }

/// True if it is the cell's turn to be traced again in this update. Turns do not depend on light, so they cause no
/// bias.
bool is_its_turn(const formats::RadsamplesRecord& record, std::uint32_t cell) {
  return (mix64(record.key + cell) + record.updates) % kTurns == 0;
}
bool holds(const Box3& box, Vec3 p) { return min(p, box.lower) == box.lower && max(p, box.upper) == box.upper; }

}  // namespace

bool is_bright(const TemporalScene& scene, std::uint32_t point) {
  return (point < scene.high_shares.size() && scene.high_shares[point] > 0) ||
         (point < scene.lookup.size() && scene.lookup.light(point).beside_lamp);
}

LightChanges light_changes(const TemporalScene& scene, const KeptHemispheres& kept, bool explicitly) {
  TEMPOLUX_CHECK(kept.point_light.size() <= scene.points.size());
  LightChanges changes;
  const SceneFrame& now = scene.tracer.frame();
  changes.boxes = swept_boxes(*scene.before, now);
  changes.materials = now.hashes.materials != scene.before->hashes.materials;
  changes.divided = explicitly || !kept.high_hash.empty() || !scene.high_hash.empty();
  changes.anything = changes.materials || !changes.boxes.empty() || kept.high_hash != scene.high_hash;
  changes.points.resize(kept.point_light.size(), unmarked);
  changes.ratios.resize(changes.points.size(), Rgb(1.0f));
  for (std::size_t i = 0; i < changes.points.size(); ++i) {
    const Rgb before = kept.point_light[i], light = scene.points[i].total();
    if (is_bright(scene, std::uint32_t(i))) changes.points[i] = lost;  // A bright point is no anchor.
    if (before == light || changes.points[i] == lost) continue;
    changes.points[i] = scaled;
    changes.anything = true;
    for (int c = 0; c < 3; ++c) {
      if (before[c] == light[c]) continue;
      // If `before` is 0, the ratio is infinite and the cells are traced again.
      const float ratio = changes.ratios[i][c] = light[c] / before[c];
      if (!(ratio <= kLargestRatio && ratio * kLargestRatio >= 1)) changes.points[i] = lost;
    }
  }
  return changes;
}

bool mark_cells(const KeptHemisphere& kept, const LightChanges& changes, const GatherDirections& directions,
                SampleUnits units, std::vector<std::uint8_t>& marks) {
  const std::size_t cells = kept.samples.size();
  marks.assign(cells, changes.materials ? std::uint8_t(moved) : std::uint8_t(unmarked));
  for (std::size_t c = 0; c < cells; ++c) {
    const std::uint16_t flags = kept.samples[c].flags;
    if (!(flags & formats::sample_valid) || marks[c]) continue;
    if (flags & formats::sample_dynamic) {
      marks[c] = moved;
    } else if (flags & formats::sample_anchored) {
      marks[c] = changes.points[kept.anchors[c]];
    } else if (flags & formats::sample_near) {
      // Without an anchor and without a hit along its ray a cell is black under any light, and stays unmarked.
      marks[c] = unanchored;
    }
  }
  for (const Box3& box : changes.boxes) {
    const CellsTowards towards(kept.position(), directions.frame(), box, kept.record.rings, kept.record.sectors);
    towards.for_each([&](std::uint32_t c) {
      if (!(kept.samples[c].flags & formats::sample_valid) || marks[c] == moved) return;
      const bool miss = kept.samples[c].flags & formats::sample_miss;
      const float distance = miss ? INFINITY : units.decode(kept.samples[c].distance) * (1 + 0x1p-10f);
      Ray ray;
      std::uint64_t key = 0;
      if (directions.aim(c, kept.draw_of(c), ray, key) && meets(ray, distance, box)) marks[c] = moved;
    });
  }
  if (std::none_of(marks.begin(), marks.end(), [](std::uint8_t mark) { return mark != unmarked; })) return false;
  for (std::uint32_t c = 0; c < cells; ++c)
    if (marks[c] <= scaled && (kept.samples[c].flags & formats::sample_near) && is_its_turn(kept.record, c))
      marks[c] = near;
  return true;
}

bool near_a_mover(const KeptHemisphere& kept, const LightChanges& changes, float reach) {
  return std::any_of(changes.boxes.begin(), changes.boxes.end(),
                     [&](const Box3& box) { return holds(grown(box, std::min(reach, 1e15f)), kept.position()); });
}

}  // namespace tempolux
