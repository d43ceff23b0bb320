// lib/gather/world_records.h -- irradiance records at places that follow from the surfaces alone, so that what a record
// holds depends on its place and not on cameras, frames or other records that were asked for
// (docs/methods/records.md).
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <span>
#include <vector>

#include "lib/gather/place_records.h"
#include "lib/gather/world_places.h"
#include "lib/scene/moving_objects.h"

namespace tempolux {

/// A seen point, reduced to what placing needs, and the look that finds it again.
struct WantedPoint {
  WantedPlace place;
  int level = 0;  ///< log2 of the footprint, rounded: places of one level have records of the same radii
  int frame = 0;
  std::uint32_t pixel = 0, look = 0;  ///< look 0: centre_look(pixel); look k + 1: edge_look(pixel, k)

  Look where(int width) const { return look == 0 ? centre_look(pixel, width) : edge_look(pixel, width, look - 1); }
};

/// The points of all pixel centres, and of the further looks of edge pixels, in a fixed order.
std::vector<WantedPoint> wanted_points(const PixelView& view, int frame, int width, int height);

/// Places records in three steps: want() for all points that cameras see, choose(), and gather().
///
/// choose() goes through classes of places (world_places.h) from wide to narrow spacing. A place gets a record if the
/// weights of the records of wider classes add up to less than PlacementOptions::min_weight there. So the records of a
/// level follow from the surfaces, not from what was wanted, except at the border of the wanted region: only places
/// whose record may reach a wanted place are tested, so a wider record outside may be missing, and a place may get a
/// record that it would not get otherwise.
class WorldRecords {
 public:
  /// Surfaces that move in the segment get no records. The arguments must outlive this object.
  WorldRecords(const FinalGather& gather, const Tracer& tracer, const PlacementOptions& options);

  /// Adds seen points; called once a camera.
  void want(std::span<const WantedPoint> wanted);
  /// Decides which places get records, without gathering; adds its distance rays to `counts`.
  void choose(GatherCounts& counts);

  /// Share of GatherOptions::rays for the record of a point, in [1/8, 1]; empty: 1.
  using RayShare = std::function<float(const SeenPoint&)>;
  /// Gathers the records that can light a wanted place and adds them to `store`. A record that two levels need gets
  /// the larger of both radii. Every 32nd record is gathered twice to scale the noise of all, as in place_records().
  /// Same records for any number of threads.
  void gather(const RayShare& share, RecordStore& store, GatherCounts& counts) const;

  /// Wanted places where the weights of the records in `store` add up to less than `weight`. These are on movers, and
  /// on small surfaces that no line meets. Ascending by frame, in a random order within a frame.
  std::vector<WantedPoint> gaps(const RecordStore& store, float weight) const;

 private:
  struct Member {
    std::uint64_t key;  ///< of the place
    SeenPoint seen;
    IrradianceRecord record;  ///< without light
    float range;              ///< m: harmonic mean distance of what the place sees
    float most_radius;        ///< m: limit of the radius in this class
  };
  struct Level {
    /// Element c: one wanted place a cell of class 2 level + c and direction.
    std::vector<std::vector<WantedPoint>> wanted{1};
    RecordStore placed;  ///< the members' records
    std::vector<Member> members;
  };

  PlacementOptions limited(float most_radius) const;
  std::optional<Member> member_at(const WorldPlace& place, int level, int spacing_class, const RecordStore& placed,
                                  GatherCounts& counts) const;
  void choose_in_level(int number, Level& level, GatherCounts& counts) const;
  std::vector<std::uint8_t> needed(int number, const Level& level) const;
  IrradianceRecord gathered(const FinalGather& gather, const Member& member, const RayShare& share,
                            GatherCounts& counts) const;

  const FinalGather& gather_;
  const Tracer& tracer_;
  PlacementOptions options_;
  /// The classes tested in level l are 2 l + widest_ down to 2 l + narrowest_. The widest spacing is twice the radius
  /// of records all of whose rays miss: 64 footprints. The narrowest is the smallest radius over root 2: 2.83
  /// footprints. Records of the smallest radius cover a surface at that spacing.
  int widest_, narrowest_;
  MovingObjects moving_;
  std::map<int, Level> levels_;
};

}  // namespace tempolux
