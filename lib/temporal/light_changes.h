// lib/temporal/light_changes.h -- finds what differs between two frames, and which cells of a record are concerned.
#pragma once

#include <cstdint>
#include <vector>

#include "lib/temporal/swept_boxes.h"
#include "lib/temporal/temporal_gather.h"

namespace tempolux {

/// What happens to a cell in this frame. `unmarked`: the cell does not change. `scaled`: its radiance is scaled with
/// its anchor's light. All further marks: the cell is traced again; the mark names the reason (TemporalCounts).
enum Mark : std::uint8_t { unmarked = 0, scaled, moved, lost, unanchored, near, aged, all };
inline bool is_traced(std::uint8_t mark) { return mark > scaled; }

/// The differences between the kept frame and the present one.
struct LightChanges {
  std::vector<Box3> boxes;  ///< m; around both places of each surface that has moved
  /// One entry per point that may be an anchor: unmarked, scaled or lost. `ratios` holds the factor by which the
  /// point's light changed. It is a separate array, since few cells read it.
  std::vector<std::uint8_t> points;
  std::vector<Rgb> ratios;
  bool anything = false, materials = false;  ///< true if anything, or a material, has changed
  /// True if light is sampled explicitly, or some points were bright in the frame before. Where a lamp was close to a
  /// surface in the frame before alone, all cells that saw the spot are marked.
  bool divided = false;
};
/// Compares the points, the moving surfaces and the materials of `scene` with those that `kept` was gathered from.
/// explicitly: records sample light explicitly in this frame (GatherOptions::bright).
LightChanges light_changes(const TemporalScene& scene, const KeptHemispheres& kept, bool explicitly);

/// True if photonmap-split gave the point a high part, or PointLookup::note_lamp found a lamp close to the point.
/// Gather rays bring only a part of the point's light, and this part depends on the length of the ray.
bool is_bright(const TemporalScene& scene, std::uint32_t point);
/// Writes a Mark for each cell of a record. False if all cells are unmarked.
bool mark_cells(const KeptHemisphere& kept, const LightChanges& changes, const GatherDirections& directions,
                SampleUnits units, std::vector<std::uint8_t>& marks);
/// True if the record lies in a box of `changes`, grown by `reach` [m] to each side: something has moved close by.
bool near_a_mover(const KeptHemisphere& kept, const LightChanges& changes, float reach);

}  // namespace tempolux
