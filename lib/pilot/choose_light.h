// lib/pilot/choose_light.h -- chooses the way to light with the least work for an error, and its numbers of rays.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "lib/pilot/rough_frame.h"

namespace tempolux {

/// How a frame finds indirect light. records: pixels interpolate between records. gather: each sample of a pixel sends
/// one gather ray, which ends at irradiance points. paths: camera paths are followed to their random end.
enum class IndirectMethod : std::uint8_t { records, gather, paths };
inline constexpr const char* kIndirectMethods[] = {"records", "gather", "paths"};

/// The picture to be rendered. Its light is charged to it alone, even if other frames share the files.
struct Order {
  double pixels = 0;                ///< number of pixels of the picture
  std::uint64_t photons = 700'000;  ///< light paths of the photon map, at least
  bool filtered = true;             ///< lib/filter reduces the noise of samples
  std::uint64_t most_photons = 0;   ///< light paths of the map, at most (AskedPicture)
  double pictures = 1;              ///< number of pictures that share light paths above `photons`
};

/// A way to light, with its estimated work and error.
struct Way {
  IndirectMethod method = IndirectMethod::paths;
  bool map = false;           ///< visible caustic light comes from photons; else camera paths find it
  int rays = 0;               ///< gather rays per record
  double work = 0;            ///< shadow rays, for the whole picture
  double error = 0;           ///< squared error, mean over the pixels, in the unit of SampleEffort
  double pixel_error = 1;     ///< factor for the wish's pixel error
  std::uint64_t photons = 0;  ///< light paths of the photon map
  bool measured = true;       ///< false: work and error are lower bounds
  double never = 0;           ///< MissedLight::never of the layers that the way samples
  double uncertain = 0;       ///< MissedLight::uncertain of these layers
  double score() const { return work * error; }  ///< the least is best
};

/// All ways in ascending order of work x squared error; ways that surely miss light (Way::never, Way::uncertain) come
/// last. caustics: may visible caustic light come from photons? A picture of P pixels takes n samples per pixel, each
/// of work c and variance V. It has M records of k gather rays; a ray costs the work g, and a record has the squared
/// error e / k.
///
///     work = fixed + P c n + M g k,   error = E / G + e / k + B,   n = V / E
///
/// fixed: work of photons and points. E: squared error that the wish allows in all light but layer indirect, which all
/// ways sample. G: factor by which the filter reduces the noise of samples; it does not reduce e / k, because
/// neighbouring pixels share records and their errors. B: error that does not fall with work, of a density of caustic
/// photons and of light that photons show and paths miss. The product is least for
///
///     k = sqrt(e (fixed + P c n) / (M g (E / G + B)))
///
/// Work and error are those with the wish's light paths and pixel error. A filtered picture with a map then gets the
/// numbers of spread_work(), with less work and the same seen error. Way::pixel_error also allows for the variance of
/// ways whose samples find indirect light.
std::vector<Way> ways_to_light(const RoughFrame& rough, const Order& order, bool caustics);

/// The ways for several frames together, in the same order: each with the sums of work and error over the frames, the
/// largest numbers of rays and photons, the smallest pixel error and the largest shares of missed light.
std::vector<Way> joined(const std::vector<std::vector<Way>>& ways_of_frames);

/// Text that explains the order of `ways` (not empty): the score of each way over that of the first, and the light that
/// ways miss.
std::string because(const std::vector<Way>& ways);

}  // namespace tempolux
