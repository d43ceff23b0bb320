// lib/temporal/temporal_gather.h -- keeps the samples of records from frame to frame; each frame traces only cells that
// are old or changed.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "lib/gather/place_records.h"
#include "lib/temporal/ageing.h"
#include "lib/temporal/kept_hemisphere.h"

namespace tempolux {

struct TemporalOptions {
  /// Share of the cells of a record that a frame traces again if the record's light changed. Cells with a reason (their
  /// ray or their point's light changed) are traced first. Cells drawn by age make up the rest of the share, at least a
  /// quarter of the share.
  float refresh = 0.05f;
};

/// Counts of one frame.
/// - Cells that were traced again, by reason. `moved`: something moved across the cell's ray, or the ray's hit moved.
///   `lost`: the light of the anchor became more than twice or less than half as strong. `unanchored`: no point
///   represents the hit. `near`: a close hit whose turn it was. `aged`: drawn by age, with a new ray.
/// - `cells`: cells of all records. `scaled`: cells whose radiance was multiplied by the ratio of their anchor's light.
/// - `records`: records after the frame. `kept`: records that did not change. `explicit_only`: records in which only
///   bright points were sampled anew. `born`: new records. `removed`: records whose place is gone. `deforming`: further
///   records that are removed, because their surface changes its shape.
/// - `update`, `birth`: rays of kept and of new records.
struct TemporalCounts {
  std::uint64_t cells = 0, moved = 0, lost = 0, unanchored = 0, near = 0, aged = 0, scaled = 0;
  std::uint64_t records = 0, kept = 0, explicit_only = 0, born = 0, removed = 0, deforming = 0;
  GatherCounts update, birth;
  std::vector<std::uint64_t> ages;  ///< number of cells by age, after the frame
};

/// The inputs of a frame's temporal gathering; all must outlive the gathering.
struct TemporalScene {
  const Tracer& tracer;
  const Lights& lights;
  const PointLookup& lookup;
  std::span<const IrradiancePoint> points;  ///< of the lookup
  std::size_t anchored_points = 0;          ///< the first points, on static surfaces, which may be anchors
  const SceneFrame* before = nullptr;       ///< scene at the kept frame; nullptr: nothing is kept
  /// With GatherOptions::bright: the share of each point's light that is sampled explicitly, and a hash of all shares.
  /// Else empty.
  std::span<const float> high_shares = {};
  std::string high_hash = {};
  /// Position of the camera that a place sees, scene space; nothing if the place is outside the picture. Records with
  /// the smallest radius that a mover has hidden from the camera get a smaller radius; without this function none does.
  std::function<std::optional<Vec3>(Vec3)> eye = {};
};

struct LightChanges;  // lib/temporal/light_changes.h

/// Number of a frame's first points that lie on static surfaces.
std::size_t anchored_points(const SceneFrame& frame, std::span<const IrradiancePoint> points);

/// Gathers one frame from the kept records of the previous one. The same records for any number of threads.
class TemporalGather {
 public:
  /// `diagonal`: sample_unit() of the frame.
  TemporalGather(const TemporalScene& scene, const GatherOptions& gather, const PlacementOptions& placement,
                 const TemporalOptions& options, float diagonal);

  /// Updates the kept records to this frame. Records on deforming surfaces, and on triangles that have no area at one
  /// of the frames, are removed. Any other record changes if one of these cases holds for one of its cells; otherwise
  /// it stays the same to the bit:
  /// - The cell's ray meets a box in which something has moved, or its hit moves. The cell is traced again along its
  ///   old direction. A new direction would cause a bias: rays that hit the mover would be replaced, and rays that miss
  ///   it kept.
  /// - The light of the point that represents the cell's hit has changed. The cell's radiance is scaled by the ratio,
  ///   per channel; outside the range 1/2 to 2 the cell is traced again along its old direction.
  /// - No point represents the cell's hit (mirrors, corners). The cell is traced again along its old direction.
  /// If a record changes, two more sets of its cells are traced: cells whose radiance depends on several points (close
  /// hits) in turn, each in every eighth update; and cells drawn by age, which get a new ray in their stratum
  /// (TemporalOptions::refresh).
  /// Cells that hit a bright point have no anchor, because the light that a ray contributes from a bright point depends
  /// on the ray's length, too. If anything has changed, bright points are sampled anew for every record, with the
  /// record's own random numbers.
  void advance(KeptHemispheres& kept, TemporalCounts& counts) const;
  /// Puts the kept records into a store, and places new records at visible places that the kept records do not cover;
  /// new records are kept, too. After a change a record is superfluous if at its place the sum of the weights of all
  /// earlier records is larger by 1 than when the record was placed. A superfluous record fades out over four frames.
  void place(RecordPicture picture, KeptHemispheres& kept, RecordStore& store, TemporalCounts& counts) const;

 private:
  struct Marked;
  bool is_hidden(const SurfacePoint& place, const formats::RadsamplesRecord& before,
                 const IrradianceRecord& made) const;
  bool mark(KeptHemisphere& kept, const LightChanges& changes, Marked& marked) const;
  void update(KeptHemisphere& kept, const LightChanges& changes, double aged_share, Marked& marked,
              TemporalCounts& counts) const;
  void update_all(KeptHemispheres& kept, const LightChanges& changes, const std::vector<bool>& gone,
                  TemporalCounts& counts) const;
  void trace_cells(const SurfacePoint& place, KeptHemisphere& kept, const GatherDirections& directions,
                   std::span<const std::uint8_t> marks, GatherCounts& counts) const;
  void finish(const SurfacePoint& place, KeptHemisphere& kept, const LightChanges* changes, GatherCounts& counts) const;
  KeptHemisphere birth(const SeenPoint& seen, GatherCounts& counts) const;
  SurfacePoint place_of(const KeptHemisphere& kept) const;
  void move_with_surface(KeptHemisphere& kept) const;
  void fill(KeptHemispheres& kept, RecordStore& store) const;

  TemporalScene scene_;
  GatherOptions gather_options_;
  PlacementOptions placement_;
  TemporalOptions options_;
  SampleUnits units_;
  FinalGather gather_;
  GatherStrata strata_;  ///< of new records
};

}  // namespace tempolux
