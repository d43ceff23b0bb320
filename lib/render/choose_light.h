// lib/render/choose_light.h -- by which way a frame's light is found, and how much work goes where: what costs least
// for the error.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "lib/render/rough_frame.h"

namespace tempolux {

/// How the light that surfaces send each other is found: by records between pixels, by one ray of the hemisphere for
/// each sample of a pixel, which ends at irradiance points, or by paths that end nowhere but in the dark.
enum class IndirectMethod : std::uint8_t { records, gather, paths };
inline constexpr const char* kIndirectMethods[] = {"records", "gather", "paths"};

/// What is to be rendered: one picture, as if no other shared its light.
struct Order {
  double pixels = 0;                ///< of a picture
  std::uint64_t photons = 700'000;  ///< paths of light
  int rays = 500;                   ///< of a record at most
  bool filtered = true;             ///< lib/filter reduces the noise of samples
};

/// One way to a frame's light.
struct Way {
  IndirectMethod method = IndirectMethod::paths;
  bool map = false;        ///< caustic light where the eye looks is read from photons; else paths find it
  int rays = 0;            ///< of a record
  double work = 0;         ///< shadow rays, for a picture
  double error = 0;        ///< squared, mean over the pixels, as SampleEffort has it
  double pixel_error = 1;  ///< of frames, so that their samples leave the error that all ways have alike: of the wish
  bool measured = true;    ///< or the least that work and error can be
  double score() const { return work * error; }
};

/// All ways, the best one first: the least work x squared error. With n samples a pixel, c work for each, V their
/// variance, and M records of k rays, e / k their squared error, g the work for a ray:
///
///     work = fixed + P c n + M g k,   error = E / G + e / k + what stays wrong,   n = V / E
///
/// E is what the wish leaves of light that all ways find alike. G is what the filter makes of the noise of samples: a
/// pixel's noise is independent of its neighbours', a record's error is not, so the filter leaves e / k as it is. Least
/// for k = sqrt(e (fixed + P c n) / (M g (E / G + what stays wrong))): so work goes to records in proportion to the
/// root of error x cost, as to samples. Wrong stay caustics by a density of photons, and light that photons show and
/// paths do not meet.
std::vector<Way> ways_to_light(const RoughFrame& rough, const Order& order, bool caustics);

/// The same for several frames together: of each way the work and the error of all, and the most rays.
std::vector<Way> joined(const std::vector<std::vector<Way>>& ways_of_frames);

/// Why the first of them is.
std::string because(const std::vector<Way>& ways);

}  // namespace tempolux
