// lib/render/spread_outliers.h -- spreads light that a single sample of a pixel found over the pixels around.
#pragma once

#include <functional>
#include <span>
#include <vector>

#include "lib/render/pixel_samples.h"

namespace tempolux {

/// The brightest sample of one part of a pixel, in the layer in which the sample is brightest, and the second of that
/// layer. Layer emission is ignored: it holds edges of what the camera sees, not outliers.
struct BrightestSample {
  Rgb radiance{0.0f};   ///< W/m^2/sr
  Rgb second{0.0f};     ///< the brightest of the other samples noted so far in the same layer; 0: none
  float brightest = 0;  ///< sum of the channels of `radiance`
  Layer layer = Layer::specular;
  void note(const Layers& sample);
};

/// The brightest sample of each part of a pixel (PathParts).
struct BrightestSamples {
  BrightestSample own, lit, onward;
  void note(const PathParts& sample) {
    own.note(sample.own);
    lit.note(sample.lit);
    onward.note(sample.onward);
  }
};

/// Further samples of a pixel, which only decide whether its bright sample is an outlier. The picture does not include
/// them, so it stays unbiased.
struct FurtherSamples {
  PathParts mean;
  PartCounts count;
};
/// The least number of samples that decides about an outlier. An object that covers a quarter of a pixel is rightly
/// met by one of four stratified samples, and then by three of 12 more.
inline constexpr int kJudges = 16;

/// A picture whose pixels have all their samples. Every span holds width * height elements, top row first.
struct SampledPixels {
  int width = 0, height = 0;
  std::span<const PathParts> parts;    ///< means
  std::span<const PartCounts> counts;  ///< number of samples of each part, at least one
  std::span<const BrightestSamples> brightest;
  std::span<const std::uint8_t> mask;  ///< 0: the pixel neither gives nor gets light; empty: all pixels do
  /// The error that a pixel may have for a radiance around it [W/m^2/sr]; if it is 0, nothing is taken; thread-safe.
  std::function<double(double)> error;
  /// By pixel the index in `further`, or kNone; empty: no pixel has further samples.
  std::span<const std::uint32_t> further_of{};
  std::span<const FurtherSamples> further{};
  bool takes_part(std::size_t pixel) const { return mask.empty() || mask[pixel] != 0; }
};

/// The error that each pixel may have, from the median of the radiance around it: the outliers themselves do not raise
/// their limit. 0 for pixels without a surface and outside the mask: these neither give nor get light.
std::vector<double> allowed_errors(const SampledPixels& samples, const std::vector<Layers>& pixels);

/// Energy-preserving filter of outliers [Rushmeier, Ward: Energy preserving non-linear filters, SIGGRAPH 1994],
/// docs/methods/outliers.md.
///
/// Each of the two brightest samples of a part keeps a contribution of at most
///     error(radiance around) + max(mean of the pixel's other samples, mean of the 24 pixels around), in its layer;
/// the other samples include FurtherSamples. The excess is the outlier. Outliers are spread in ascending order of their
/// light, each over the smallest box in which its light per pixel is below the allowed error and its squared error,
/// added to the light that was spread there before, is less than the visible squared error of the bright pixel. An
/// outlier for which no box suffices stays in its pixel.
///
/// A pixel receives light in proportion to its allowed error; a pixel without a surface (coverage 0) neither gives nor
/// receives. The sum of a layer over the picture stays the same up to rounding. Returns the share of the picture's
/// light that was spread. errors: allowed_errors().
double spread_outliers(const SampledPixels& samples, const std::vector<double>& errors, std::vector<Layers>& pixels);

/// Pixels with fewer than kJudges samples of a part that has an outlier: further samples are to decide about it.
/// Ascending. errors: allowed_errors().
std::vector<std::size_t> pixels_to_judge(const SampledPixels& samples, const std::vector<Layers>& pixels,
                                         const std::vector<double>& errors);

}  // namespace tempolux
