// lib/pilot/spread_work.h -- spreads the work of a picture over samples, photons and gather rays so that what is seen
// after the filter costs least.
#pragma once

#include <cstdint>
#include <iterator>

#include "lib/pilot/rough_frame.h"

namespace tempolux {

/// Squared error of caustic light that a map of `photons` light paths gives to a filtered picture of `pixels` pixels,
/// as a viewer sees the error: the sum over boxes of a = 1, 25 and 225 pixels of
///     2.4 light^2 / (k + d (a - 1 + g)).
/// k = 25 photons light a pixel, however many photons the map has. d is the number of photons per pixel: the mean over
/// a box also averages the photons of the box, and the filter averages g = 16 pixels. A density of n photons has the
/// squared error 2.4 light^2 / n. Without light the error is 0.
double seen_map_error(const RoughFrame& rough, double pixels, std::uint64_t photons);

/// Sides of the boxes, in pixels, over which an error is seen: those of tests/bench/steady.py.
inline constexpr double kSeenBoxes[] = {1, 5, 15};
/// Sum of the squared errors of all these boxes over the squared error of single pixels (docs/methods/ways.md).
struct Seen {
  static constexpr double kSamples = 1.24, kRecords = 2.1;  ///< of filtered samples and of records, measured
  static double independent() {                             ///< of independent samples: 1 + 1/25 + 1/225
    double sum = 0;
    for (const double box : kSeenBoxes) sum += 1 / (box * box);
    return sum;
  }
  static double smooth() { return double(std::size(kSeenBoxes)); }  ///< of what differs little over 15 pixels
};

/// The work and the error of a filtered picture with a map of caustic photons, if it takes the samples that the wish's
/// pixel error asks for.
struct AskedPicture {
  double pixels = 0;        ///< of the picture
  double sample_work = 0;   ///< shadow rays of one sample
  double samples = 0;       ///< of a pixel, if samples were independent: variance / wished error
  double sample_error = 0;  ///< squared error that independent samples leave after the filter (SampleEffort)
  double ray_work = 0;      ///< shadow rays of one gather ray of every record; 0 without records
  double ray_error = 0;     ///< squared error of records at one gather ray each; 0 without records
  int rays = 0;             ///< gather rays of a record; 0 without records
  std::uint64_t photons = 0, most_photons = 0;  ///< light paths of the map, at least and at most
  double pictures = 1;                          ///< number of pictures that share light paths above `photons`
  double work = 0;                              ///< shadow rays of the whole picture; light paths cost at most as much
};

/// The numbers that replace those of an AskedPicture.
struct SpreadWork {
  double samples = 1;  ///< share of the samples
  int rays = 0;
  std::uint64_t photons = 0;
};

/// The numbers with the least product of the picture's work and its seen error, among those that leave at most the seen
/// error of `asked`. The share s of the samples is 2^(-i/4), at least 1/8, and leaves at least 4 samples a pixel. Light
/// paths are doubled; rays are halved, doubled or quadrupled. The seen error is
///     1.24 E s^-.75 + seen_map_error() + 2.1 e / rays      (Seen).
/// E is the squared error of the asked samples; n stratified samples leave n^(1-r) times the error of independent ones
/// (stratified_rate()). e is the squared error of records at one ray.
SpreadWork spread_work(const RoughFrame& rough, const AskedPicture& asked);

}  // namespace tempolux
