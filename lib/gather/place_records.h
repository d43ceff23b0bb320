// lib/gather/place_records.h -- places irradiance records where a camera needs them (docs/methods/records.md).
#pragma once

#include <cmath>
#include <cstdint>
#include <functional>
#include <span>

#include "lib/gather/final_gather.h"
#include "lib/gather/seen_points.h"

namespace tempolux {

struct PlacementOptions {
  float error_bound = 0.2f;  ///< radius of a record over the harmonic mean distance of the surfaces around it
  float min_radius_px = 4;   ///< smallest radius of a record, in pixels
  /// Radius in pixels if all rays miss, so that no distance limits the radius. Mitsuba and PBRT limit all radii to 7
  /// and 6 times the smallest radius.
  float unseen_radius_px = 32;
  float max_radius = INFINITY;  ///< m: largest radius that distances give
  /// A place is covered if the records' weights add up to this. A record has the weight 1 at its own place.
  float min_weight = 0.9f;
};

/// Makes records in place of FinalGather::gather, for callers that keep the gathered radiance.
struct RecordSource {
  /// Makes a record with its limited radius and its clearance. `slot`: number, below kPlacedTogether, of the record
  /// among those that are gathered in parallel.
  std::function<IrradianceRecord(const SeenPoint&, std::size_t slot, GatherCounts&)> gather;
  /// Called when the record of a slot has been added to the store; may be empty.
  std::function<void(std::size_t slot)> added = {};
};
/// Places of a batch. Records of one batch do not cover each other's places. Half and twice the value change the seen
/// error less than another seed does (docs/notebook/constants.md).
inline constexpr std::size_t kPlacedTogether = 256;

/// A picture that needs records.
struct RecordPicture {
  PixelView view;
  int width, height;                          ///< pixels
  std::function<void(double)> progress = {};  ///< called with values in [0, 1]; may be empty
  const RecordSource* source = nullptr;       ///< makes the records; null: FinalGather::gather makes them
};

/// Adds records until every pixel's place is covered: the weights of the records there add up to at least
/// options.min_weight. Tests the places that pixel centres see, on lattices with a stride of 16, 8, 4, 2 and 1 pixels.
/// The places of a lattice are tested in a fixed shuffled order and in batches of fixed size. The places of a batch are
/// tested and gathered in parallel, and their records are added in order. Then tests four more places in each pixel at
/// an edge or behind glass, so that a frame's samples find records there, too. Same records for any number of threads.
/// Returns the number of added records.
///
/// The noise of the added records is completed by noise_factor(counts).
std::size_t place_records(const FinalGather& gather, const RecordPicture& picture, const PlacementOptions& options,
                          RecordStore& store, GatherCounts& counts);

/// Goes through the points in their order and in batches of kPlacedTogether. Adds a record at a point where the weights
/// of the records add up to less than options.min_weight. `source` makes the records; null: `gather` does. Same records
/// for any number of threads.
void cover_points(const FinalGather& gather, const RecordSource* source, const PlacementOptions& options,
                  std::span<const SeenPoint> points, RecordStore& store, GatherCounts& counts);

/// Factor by which counted noise falls short of the true noise: the root of variance over noise squared; 1 if no record
/// was gathered twice.
float noise_factor(const GatherCounts& counts);

/// Radius r [m] of a record from R = record.radius_unclamped, the harmonic mean distance of the surfaces around it
/// (FinalGather::distance) [Ward, Rubinstein and Clear 1988]: error_bound R, or unseen_radius_px footprints if R is
/// infinite, at most max_radius, but at least min_radius_px footprints [Tabellion and Lamorlette 2004]. `footprint`
/// [m]: size of a pixel.
float radius_of(const IrradianceRecord& record, float footprint, const PlacementOptions& options);

/// Sets the radius of a gathered record to radius_of(). radius_unclamped, which is R before, becomes r without the
/// limit by min_radius_px. If radius_unclamped is the smaller of the two, multiplies the translational gradient by
/// radius_unclamped / radius: next to a wall the gradient is large, noisy and valid within radius_unclamped only
/// [Jakob, Mitsuba 0.6]. Then reduces the gradient so far that the irradiance is not negative within the radius.
void limit_radius(IrradianceRecord& record, float footprint, const PlacementOptions& options);

}  // namespace tempolux
