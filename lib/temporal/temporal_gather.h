// lib/temporal/temporal_gather.h -- records whose samples are kept from frame to frame: a frame shoots only what age or
// motion asks for.
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

/// How many cells are drawn by age, with a share to be refreshed: so many that those with a reason and these make up
/// the share, a quarter of it at least; or the share of all cells without a reason.
enum class RefreshRule { adaptive, fixed };

struct TemporalOptions {
  float refresh = 0.05f;  ///< share, of the cells of the records whose light changed in a frame
  RefreshRule rule = RefreshRule::adaptive;
  AgeWeight age_weight = AgeWeight::square;  ///< of cells that get a new ray
};

/// rays of gather: of new records and their continuations. Cells that were traced again: `moved` along their old ray,
/// as what moves was or is in the way; `lost`: their anchor's light is more than twice or less than half of what it
/// was; `unanchored`: nothing stands for what they met; `near`: it was the turn of a hit near by; `aged` got a new ray.
/// `scaled` read their anchor's new light; `kept` records had no reason to change; of `explicit_only` none of the cells
/// had.
struct TemporalCounts {
  std::uint64_t cells = 0, moved = 0, lost = 0, unanchored = 0, near = 0, aged = 0, scaled = 0;
  std::uint64_t records = 0, kept = 0, explicit_only = 0, born = 0, fading = 0, removed = 0, deforming = 0;
  GatherCounts update, birth;
  std::vector<std::uint64_t> ages;  ///< cells by age, after the frame
};

/// What a frame's temporal gathering reads; all of it must outlive it.
struct TemporalScene {
  const Tracer& tracer;
  const Lights& lights;
  const PointLookup& lookup;
  std::span<const IrradiancePoint> points;  ///< of the lookup
  std::size_t anchored_points = 0;          ///< the first of them, on what stands still, may be anchors
  const SceneFrame* before = nullptr;       ///< the scene at the frame that was kept; null: nothing is kept
  /// With GatherOptions::bright: the share of each point's light that is sampled explicitly, and a hash of them all;
  /// without: empty.
  std::span<const float> high_shares = {};
  std::string high_hash = {};
  /// From where the camera looks at a place; nothing if it looks away. Records that something comes close to keep the
  /// smallest radius if it sees them; empty: all do.
  std::function<std::optional<Vec3>(Vec3)> eye = {};
};

struct LightChanges;  // lib/temporal/light_changes.h

/// How many of a frame's first points lie on what stands still.
std::size_t anchored_points(const SceneFrame& frame, std::span<const IrradiancePoint> points);

/// One frame. Same records for any number of threads.
class TemporalGather {
 public:
  TemporalGather(const TemporalScene& scene, const GatherOptions& gather, const PlacementOptions& placement,
                 const TemporalOptions& options, float diagonal);

  /// Brings what was kept to this frame. The records of what deforms, and of what is not there at one of the frames,
  /// are left out. Of the others a record changes where one of these holds, else it stays to the bit:
  /// - a cell's ray, from the place to what it met, meets a box in which something has moved, or what it met moves:
  /// traced again, *along
  ///   its old direction*. Another direction would bring a bias: what hits the mover would be thrown away, what misses
  ///   it kept;
  /// - the point that stands for what it met has other light now: the cell's radiance is scaled by the ratio, per
  /// channel, or
  ///   traced again along its old direction beyond 1/2 to 2;
  /// - no point stands for what it met (mirrors, corners): traced again alike.
  /// If a record changes, its cells whose radiance is more than one point's light (hits near by) are traced again in
  /// turn, each in every eighth update. If a record changes, further cells get a new ray in their place of the
  /// hemisphere. They are drawn by age: see TemporalOptions::refresh. Where bright points are sampled explicitly, cells
  /// that met one have no anchor, as what is left of its light follows from the distance, too; and if anything has
  /// changed the explicit part of every record is sampled anew, with the record's random numbers.
  void advance(KeptHemispheres& kept, TemporalCounts& counts) const;
  /// The records of a store, and then new ones where they do not cover what the camera sees; those are kept, too. After
  /// a change records fade away, in four frames, where those before them weigh by a whole record more than when they
  /// were placed.
  void place(const PixelView& view, int width, int height, KeptHemispheres& kept, RecordStore& store,
             TemporalCounts& counts, const std::function<void(double)>& progress = {}) const;

 private:
  const GatherStrata& strata_of(int rings, int sectors) const;
  struct Marked;
  bool outlived(const SurfacePoint& place, const formats::RadsamplesRecord& before, const IrradianceRecord& made) const;
  bool look(KeptHemisphere& kept, const LightChanges& changes, Marked& marked) const;
  void update(KeptHemisphere& kept, const LightChanges& changes, double aged_share, Marked& marked,
              TemporalCounts& counts) const;
  void update_all(KeptHemispheres& kept, const LightChanges& changes, const std::vector<bool>& gone,
                  TemporalCounts& counts) const;
  void shoot(const SurfacePoint& place, KeptHemisphere& kept, const GatherDirections& directions,
             const GatherStrata& strata, std::span<const std::uint8_t> marks, GatherCounts& counts) const;
  void finish(const SurfacePoint& place, KeptHemisphere& kept, const LightChanges* changes, GatherCounts& counts) const;
  void sample_explicit(KeptHemisphere& kept, const LightChanges& changes, GatherCounts& counts) const;
  KeptHemisphere birth(const SeenPoint& seen, float further_share, GatherCounts& counts) const;
  SurfacePoint place_of(const KeptHemisphere& kept) const;
  void ride(KeptHemisphere& kept) const;
  void fill(KeptHemispheres& kept, RecordStore& store, TemporalCounts& counts) const;

  TemporalScene scene_;
  GatherOptions gather_options_;
  PlacementOptions placement_;
  TemporalOptions options_;
  SampleUnits units_;
  FinalGather gather_;
  std::vector<GatherStrata> strata_;  ///< steps of 2^(1/4) cells
};

}  // namespace tempolux
