// lib/gather/place_records.h -- put irradiance records where a camera needs them (docs/methods/records.md).
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include "lib/core/random.h"
#include "lib/gather/final_gather.h"

namespace tempolux {

struct PlacementOptions {
  float error_bound = 0.2f;  ///< validity radius / harmonic mean distance to what is seen
  float min_radius_px = 4;   ///< a record is valid this many pixels around it at least
  /// And as many where nothing is met, so that no distance says how far it holds; Mitsuba and PBRT limit all radii to 7
  /// and 6 times the least.
  float unseen_radius_px = 32;
  float min_weight = 0.9f;  ///< sum of weights that counts as covered; a record has 1 at its own place
};

/// A surface point that a camera sees at a pixel, directly or through mirrors and glass.
struct SeenPoint {
  SurfacePoint surface;
  Vec3 normal;             ///< shading normal on the side seen
  float footprint = 0;     ///< m: size of a pixel there
  bool by_choice = false;  ///< seen through a surface that could have sent the ray elsewhere
};

/// A raster position of a picture. Where the way forks (glass, gloss) it is drawn from `random`, or the likelier one
/// without.
struct Look {
  float x = 0, y = 0;
  std::optional<PathRandom> random;
};
/// What a raster position sees. Nothing where no indirect light is needed. Thread-safe.
using PixelView = std::function<std::optional<SeenPoint>(const Look&)>;

/// Where records come from in place of FinalGather::gather, for whoever keeps what rays brought.
struct RecordSource {
  /// A record with its radius limited and its surroundings looked at. slot: below kPlacedTogether, its number among
  /// those gathered side by side.
  std::function<IrradianceRecord(const SeenPoint&, std::size_t slot, GatherCounts&)> gather;
  /// The record of a slot has become the store's last.
  std::function<void(std::size_t slot)> added;
};
inline constexpr std::size_t kPlacedTogether = 256;

/// Adds records until every pixel's point is covered: the points through the centres of lattices of 16, 8, 4, 2 and
/// 1 pixels one after the other, each in a fixed shuffled order and in batches of fixed size: a batch is tested and
/// gathered in parallel, its records are added in order. Then four more points in each pixel at an edge or behind
/// glass, so that a frame's samples find records there too. The same records for any number of threads.
/// Returns how many were added.
std::size_t place_records(const FinalGather& gather, const PixelView& view, int width, int height,
                          const PlacementOptions& options, RecordStore& store, GatherCounts& counts,
                          const std::function<void(double)>& progress = {}, const RecordSource* source = nullptr);

/// Radius r [m] of a record by R, the harmonic mean distance to what is seen (FinalGather::distance) [Ward, Rubinstein
/// and Clear 1988]: error_bound R, or unseen_radius_px footprints where R is infinite, but at least min_radius_px
/// footprints [Tabellion and Lamorlette 2004].
float radius_of(const IrradianceRecord& record, float footprint, const PlacementOptions& options);

/// Sets the radius of a gathered record, whose radius_unclamped is R; radius_unclamped keeps r before min_radius_px.
/// The translational gradient is reduced
/// - by how much the least radius is larger than what distances give: near a wall a gradient is large, noisy and holds
/// over that part only
///   [Jakob, Mitsuba 0.6];
/// - to what leaves the irradiance at or above zero within the radius.
void limit_radius(IrradianceRecord& record, float footprint, const PlacementOptions& options);

}  // namespace tempolux
