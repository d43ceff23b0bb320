// lib/temporal/light_changes.h -- finds what differs between two frames, and which cells of a record are concerned.
#pragma once

#include <cstdint>
#include <vector>

#include "lib/temporal/swept_boxes.h"
#include "lib/temporal/temporal_gather.h"

namespace tempolux {

/// What happens to a cell in this frame. `unmarked`: the cell does not change. `scaled`: its radiance is multiplied by
/// the ratio of its anchor's light. All further marks mean that the cell is traced again, and name the reason
/// (TemporalCounts).
enum Mark : std::uint8_t { unmarked = 0, scaled, moved, lost, unanchored, near, aged, all };
inline bool is_traced(std::uint8_t mark) { return mark > scaled; }

/// The differences between the kept frame and the present one.
struct LightChanges {
  std::vector<Box3> boxes;  ///< m, scene space: swept_boxes()
  /// One entry per point that may be an anchor: the Mark of its cells, which is unmarked, scaled or lost. `ratios` is
  /// the point's present light divided by its light in the kept frame.
  std::vector<std::uint8_t> points;
  std::vector<Rgb> ratios;
  bool anything = false, materials = false;  ///< true if anything, or a material, has changed
  /// True if records sample light explicitly in this frame, or did so in the kept frame. Such records are computed anew
  /// even if none of their cells is traced.
  bool divided = false;
};
/// Compares the points, the moving surfaces and the materials of `scene` with the points, surfaces and materials from
/// which `kept` was gathered.
/// explicitly: records sample light explicitly in this frame (GatherOptions::bright).
LightChanges light_changes(const TemporalScene& scene, const KeptHemispheres& kept, bool explicitly);

/// True if the point's light is sampled explicitly: it has a high part (photonmap-split), or a lamp is close to it
/// (PointLookup::note_lamp). Gather rays contribute only a part of its light, and this part depends on their length.
bool is_bright(const TemporalScene& scene, std::uint32_t point);
/// Writes a Mark for each cell of a record. False if all cells are unmarked.
bool mark_cells(const KeptHemisphere& kept, const LightChanges& changes, const GatherDirections& directions,
                SampleUnits units, std::vector<std::uint8_t>& marks);
/// True if something has moved within about `reach` [m]: the record lies in a box of `changes`, grown by `reach` to
/// each side.
bool near_a_mover(const KeptHemisphere& kept, const LightChanges& changes, float reach);

}  // namespace tempolux
