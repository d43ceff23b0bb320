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

/// The picture to be rendered. Other pictures of the shot read its photons, points and records, too, so only a share of
/// their work counts as work of this picture.
struct Order {
  double pixels = 0;                ///< number of pixels of the picture
  std::uint64_t photons = 700'000;  ///< light paths of the photon map, at least
  bool filtered = true;             ///< true if lib/filter will reduce the noise of samples
  std::uint64_t most_photons = 0;   ///< light paths of the map, at most (AskedPicture)
  double pictures = 1;              ///< number of pictures that share photons and points
  double records = 1;               ///< share of the picture's records that it is charged with
};

/// A way to light, with its estimated work and error.
struct Way {
  IndirectMethod method = IndirectMethod::paths;
  bool map = false;           ///< visible caustic light comes from photons; else camera paths find it
  int rays = 0;               ///< gather rays per record
  double work = 0;            ///< shadow rays, for the whole picture and its share of the light
  double error = 0;           ///< seen squared error (Seen), in the unit of SampleEffort
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
///     work = F / p + P c n + r M (g k + h),   error = s E / G + 2.1 e / k + 3 B,   n = V / E
///
/// F: work of photons and points, which p pictures share. r: the picture's share of its records. h: work of a record
/// without its rays. E: squared error that the wish allows in all light but layer indirect, which all ways sample. G:
/// factor by which the filter reduces the noise of samples; it does not reduce e / k, because neighbouring pixels share
/// records and their errors. B: error that does not fall with work, of a density of caustic photons and of light that
/// photons show and paths miss. s, 2.1 and 3: what is seen of an error (Seen). The product is least for
///
///     k = sqrt(2.1 e (work without rays) / (r M g (s E / G + 3 B)))
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
