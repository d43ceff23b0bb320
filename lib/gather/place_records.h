// lib/gather/place_records.h -- put irradiance records where a camera needs them.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include "lib/core/random.h"
#include "lib/gather/final_gather.h"

namespace tempolux {

struct PlacementOptions {
  float error_bound = 0.2f;           ///< validity radius / harmonic mean distance to what is seen
  float min_radius_px = 4;            ///< a record is valid this many pixels around it at least
  /// And as many at most where its rays met nothing, so that nothing tells how far it holds; Mitsuba and PBRT limit all radii to
  /// 7 and 6 times the least.
  float unseen_radius_px = 32;
  bool clamp_neighbours = true;       ///< RecordStore::clamp_with_neighbours
  float min_weight = 0.9f;           ///< sum of weights that counts as covered; a record has 1 at its own place
};

/// A surface point that a camera sees at a pixel, directly or through mirrors and glass.
struct SeenPoint {
  SurfacePoint surface;
  Vec3 normal;                        ///< shading normal on the side seen
  float footprint = 0;                ///< m: size of a pixel there
  bool by_choice = false;             ///< seen through a surface that could have sent the ray elsewhere
};

/// A raster position of a picture. Where the way forks (glass, gloss) it is drawn from `random`, or the likelier one without.
struct Look {
  float x = 0, y = 0;
  std::optional<PathRandom> random;
};
inline constexpr std::size_t kLooksTogether = 8;
/// What up to kLooksTogether positions see, near to each other as a rule: one packet of rays. Nothing where no indirect light is needed.
using PixelViews = std::function<void(std::span<const Look>, std::span<std::optional<SeenPoint>> seen)>;

/// Where records come from in place of FinalGather::gather, for whoever keeps what rays brought.
struct RecordSource {
  /// A record with its radius limited and its surroundings looked at. slot: below kPlacedTogether, its number among those gathered
  /// side by side.
  std::function<IrradianceRecord(const SeenPoint&, const RecordStore::Expected&, std::size_t slot, GatherCounts&)> gather;
  /// The record of a slot is the store's next; those of number narrows_from and later ones may have been narrowed by it.
  std::function<void(std::size_t slot, std::size_t narrows_from)> added;
};
inline constexpr std::size_t kPlacedTogether = 256;

/// Adds records until every pixel's point is covered: the points through the centres of lattices of 16, 8, 4, 2 and
/// 1 pixels one after the other, each in a fixed shuffled order and in batches of fixed size: a batch is tested and
/// gathered in parallel, its records are added in order. Up to the lattice of 2 new records may narrow those added before
/// (clamp_with_neighbours), but not those that were in the store; at the last all pixels are looked at again. Then four more points in each pixel at an edge or behind
/// glass, so that a frame's samples find records there too. The same records for any number of threads.
/// Returns how many were added.
std::size_t place_records(const FinalGather& gather, const PixelViews& views, int width, int height, const PlacementOptions& options, RecordStore& store,
                          GatherCounts& counts, const std::function<void(double)>& progress = {}, const RecordSource* source = nullptr);

/// Sets a gathered record's radius from its harmonic mean distance:
///
/// The gradients of a record that fewer than 32 of its rays make out (lit_cells) are reduced, to nothing at 8: they are
/// noise, and a radius that follows from them would depend on the light that happened to be found.
///
///     r = min(error_bound x min(R sqrt(min(1, s / 0.6)), |E| / |dE/dx|), nearest surface along the tangent plane; unseen_radius_px footprints if R is infinite),
///
/// s: expected_share, if it is known. An edge in front of light that fills a share s of the hemisphere throws a shadow whose border
/// is as wide as the edge is far times sqrt(s), or so; and of a bright thing narrower than the cells of a record its
/// gradient finds a part only (each of its borders moves as far as in full, but is met as rarely as it is narrow): such
/// borders came out blurred, up to 10 % bright. s comes from others' rays, so that radii do not follow E's noise. And at least min_radius_px footprints. radius_unclamped keeps error_bound x R sqrt(..).
void limit_radius(IrradianceRecord& record, float footprint, const PlacementOptions& options);

}  // namespace tempolux
