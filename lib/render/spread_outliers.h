// lib/render/spread_outliers.h -- light that one sample alone claims for its pixel, shared out among the pixels around.
#pragma once

#include <functional>
#include <span>
#include <vector>

#include "lib/render/pixel_samples.h"

namespace tempolux {

/// What the brightest sample of one part of a pixel brought, in the layer where it brought most. Layer emission does
/// not count: what the camera sees itself has edges, no outliers.
struct BrightestSample {
  Rgb radiance{0.0f};   ///< W/m^2/sr
  float brightest = 0;  ///< sum of its channels
  Layer layer = Layer::specular;
  /// layers: of which to note samples; for a frame that will be filtered layer specular alone.
  void note(const Layers& sample, bool specular_alone);
};

/// Of each part of a pixel (PathParts).
struct BrightestSamples {
  BrightestSample own, lit, onward;
  void note(const PathParts& sample, bool specular_alone) {
    own.note(sample.own, specular_alone);
    lit.note(sample.lit, specular_alone);
    onward.note(sample.onward, specular_alone);
  }
};

/// Further samples of a pixel by which a claim is judged; the picture does not hold them, so it stays unbiased.
struct FurtherSamples {
  PathParts mean;
  PartCounts count;
};
/// A claim is judged by so many samples at least. A thing of a quarter of a pixel is met by one of four stratified
/// samples, rightly; of 16 by three more.
inline constexpr int kJudges = 16;

/// A picture whose pixels have all their samples; every span holds width * height elements, top row first.
struct SampledPixels {
  int width = 0, height = 0;
  std::span<const PathParts> parts;    ///< means
  std::span<const PartCounts> counts;  ///< samples of each part, at least one
  std::span<const BrightestSamples> brightest;
  std::span<const std::uint8_t> mask;   ///< 0: gives nothing and gets nothing; empty: all do
  std::function<double(double)> error;  ///< by which a pixel may err, of the radiance around it [W/m^2/sr]; where it is
                                        ///< 0 nothing is taken; thread-safe
  std::span<const std::uint32_t> further_of{};  ///< by pixel the index in `further`, or kNone; empty: none has any
  std::span<const FurtherSamples> further{};
  bool takes_part(std::size_t pixel) const { return mask.empty() || mask[pixel] != 0; }
};

/// Energy-preserving filter of outliers [Rushmeier, Ward: Energy preserving non-linear filters, SIGGRAPH 1994]:
/// docs/methods/outliers.md. A sample may claim for its pixel what the pixel may err and what its other samples
/// (FurtherSamples included), or the 24 pixels around, show in that layer, whichever is more. What it claims beyond is
/// taken out of `pixels` (sums of parts) and spread over as many pixels around as it takes to be below the pixel's
/// error in each; where nothing is seen (coverage 0) none arrives. Sums of layers over the picture stay, but for
/// rounding. Returns the share of the picture's light that was spread.
double spread_outliers(const SampledPixels& samples, std::vector<Layers>& pixels);

/// Pixels that have fewer than kJudges samples of the part in which one of them claims too much: further samples are to
/// judge it. Ascending.
std::vector<std::size_t> pixels_to_judge(const SampledPixels& samples, const std::vector<Layers>& pixels);

}  // namespace tempolux
