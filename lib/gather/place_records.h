// lib/gather/place_records.h -- places irradiance records where a camera needs them (docs/methods/records.md).
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include "lib/core/random.h"
#include "lib/gather/final_gather.h"

namespace tempolux {

struct PlacementOptions {
  float error_bound = 0.2f;  ///< radius of a record over the harmonic mean distance of the surfaces around it
  float min_radius_px = 4;   ///< smallest radius of a record, in pixels
  /// Radius in pixels if all rays miss, so that no distance limits the radius. Mitsuba and PBRT limit all radii to 7
  /// and 6 times the smallest radius.
  float unseen_radius_px = 32;
  /// A place is covered if the records' weights add up to this. A record has the weight 1 at its own place.
  float min_weight = 0.9f;
};

/// A surface point that a camera sees at a pixel, directly or through mirrors and glass.
struct SeenPoint {
  SurfacePoint surface;
  Vec3 normal;             ///< shading normal on the side seen
  float footprint = 0;     ///< m: size of a pixel at the point
  bool by_choice = false;  ///< true if the path chose one of several directions at a surface
  /// The path's throughput [1] between point and camera: transmittance and reflectance on the path, divided by the
  /// probabilities of the chosen branches. With Look::random the mean of passed x (radiance of the point) is the
  /// radiance that the camera receives.
  Rgb passed{1.0f};
};

/// A raster position of a picture, in pixels. Where the path forks (glass, gloss), `random` chooses the branch; without
/// `random` the path takes the more probable branch.
struct Look {
  float x = 0, y = 0;
  std::optional<PathRandom> random;
};
/// Finds the point that a raster position sees; none if no indirect light is needed there. Must be thread-safe.
using PixelView = std::function<std::optional<SeenPoint>(const Look&)>;

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
/// One in four records of the coarsest lattice is gathered twice, with independent random numbers. Half of the squared
/// difference between both results estimates the true variance of one result. The `noise` of all added records is
/// multiplied by the square root of (true variance / mean square of `noise`). Both values are weighted as errors are
/// seen (compare()) and summed in `counts` over all calls. Records of a `source` are gathered once.
std::size_t place_records(const FinalGather& gather, const RecordPicture& picture, const PlacementOptions& options,
                          RecordStore& store, GatherCounts& counts);

/// Radius r [m] of a record from R = record.radius_unclamped, the harmonic mean distance of the surfaces around it
/// (FinalGather::distance) [Ward, Rubinstein and Clear 1988]: error_bound R, or unseen_radius_px footprints if R is
/// infinite, but at least min_radius_px footprints [Tabellion and Lamorlette 2004]. `footprint` [m]: size of a pixel.
float radius_of(const IrradianceRecord& record, float footprint, const PlacementOptions& options);

/// Sets the radius of a gathered record to radius_of(). radius_unclamped, which is R before, becomes r without the
/// limit by min_radius_px. Reduces the translational gradient
/// - by the ratio of radius_unclamped and radius, because a gradient next to a wall is large, noisy and valid only
/// within
///   the smaller radius [Jakob, Mitsuba 0.6];
/// - so far that the irradiance is not negative within the radius.
void limit_radius(IrradianceRecord& record, float footprint, const PlacementOptions& options);

}  // namespace tempolux
