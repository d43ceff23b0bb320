// lib/temporal/light_changes.h -- what differs from one frame to the next, and which cells of a record that concerns.
#pragma once

#include <cstdint>
#include <vector>

#include "lib/temporal/swept_boxes.h"
#include "lib/temporal/temporal_gather.h"

namespace tempolux {

/// What becomes of a cell: it stays, it is scaled as its anchor's light, or why it is traced.
enum Mark : std::uint8_t { unmarked = 0, scaled, moved, lost, unanchored, near, aged, all };
inline bool is_traced(std::uint8_t mark) { return mark > scaled; }

/// What has changed between the frame that was kept and the scene's.
struct LightChanges {
  std::vector<Box3> boxes;  ///< m: what has moved
  /// For each anchor: unmarked, scaled or lost. `ratios`, the change of its light, is an array of its own, as few cells
  /// ask for it.
  std::vector<std::uint8_t> points;
  std::vector<Rgb> ratios;
  bool anything = false, materials = false;
  bool divided = false;  ///< there is an explicit part, or was one in the frame before
};
LightChanges light_changes(const TemporalScene& scene, const KeptHemispheres& kept);

/// Is a part of the point's light sampled explicitly? How much rays then bring of it follows from their length, too.
bool is_bright(const TemporalScene& scene, std::uint32_t point);
/// Marks the cells that are scaled or traced again along their old ray. False if nothing about the light that rays
/// bring has changed.
bool mark_cells(const KeptHemisphere& kept, const LightChanges& changes, const GatherDirections& directions,
                SampleUnits units, std::vector<std::uint8_t>& marks);
/// Has something moved nearer than `reach` [m] to a record?
bool near_a_mover(const KeptHemisphere& kept, const LightChanges& changes, float reach);

}  // namespace tempolux
