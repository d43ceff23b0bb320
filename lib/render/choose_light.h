// lib/render/choose_light.h -- chooses the way to light of a frame, and the work for each part: the least work for
// the error.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "lib/render/rough_frame.h"

namespace tempolux {

/// How a frame finds the light that surfaces send each other. records: pixels interpolate between records. gather:
/// each sample of a pixel sends one gather ray, which ends at irradiance points. paths: camera paths, which end only
/// where they meet no light.
enum class IndirectMethod : std::uint8_t { records, gather, paths };
inline constexpr const char* kIndirectMethods[] = {"records", "gather", "paths"};

/// The picture to be rendered, as if no other picture shared its light.
struct Order {
  double pixels = 0;                ///< number of pixels of the picture
  std::uint64_t photons = 700'000;  ///< light paths of the photon map
  bool filtered = true;             ///< lib/filter reduces the noise of samples
};

/// A way to light, with its estimated work and error.
struct Way {
  IndirectMethod method = IndirectMethod::paths;
  bool map = false;        ///< visible caustic light is read from photons; else camera paths find it
  int rays = 0;            ///< gather rays per record
  double work = 0;         ///< shadow rays, for the whole picture
  double error = 0;        ///< squared error, mean over the pixels, in the unit of SampleEffort
  double pixel_error = 1;  ///< factor for the wish's pixel error, so that samples leave the error that all ways share
  bool measured = true;    ///< false: work and error are lower bounds
  double lacks = 0;        ///< share of the picture that the way surely never finds (hidden_share)
  double unsure = 0;       ///< share of the picture that too few samples meet to tell it from none
  double score() const { return work * error; }
};

/// All ways, the best one first: of those that lack no light (Way::lacks, Way::unsure) the one with the least work x
/// squared error. Let a pixel take n samples, each of work c and variance V. Let the frame have M records of k rays; a
/// ray costs the work g, and a record has the squared error e / k. P is the number of pixels. Then
///
///     work = fixed + P c n + M g k,   error = E / G + e / k + B,   n = V / E
///
/// E is the squared error that the wish allows for the light that all ways sample alike. G is the factor by which the
/// filter reduces the noise of samples. The filter does not reduce e / k, because the errors of neighbouring pixels
/// that share a record are equal. B is the error that does not fall with work: of caustic light by a density of
/// photons, and of light that photons show and paths do not meet. The product is least for
///
///     k = sqrt(e (fixed + P c n) / (M g (E / G + B)))
std::vector<Way> ways_to_light(const RoughFrame& rough, const Order& order, bool caustics);

/// The ways for several frames together: for each way the sums of work and error over the frames, the largest number
/// of rays and the smallest pixel error.
std::vector<Way> joined(const std::vector<std::vector<Way>>& ways_of_frames);

/// The reason for the first way, as text: the score of each way as a multiple of the first, and what ways lack.
std::string because(const std::vector<Way>& ways);

}  // namespace tempolux
