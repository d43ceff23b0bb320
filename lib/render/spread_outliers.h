// lib/render/spread_outliers.h -- spreads light that a single sample of a pixel found over the pixels around it.
#pragma once

#include <functional>
#include <span>
#include <unordered_map>
#include <vector>

#include "lib/render/pixel_samples.h"

namespace tempolux {

/// The brightest value of one layer in one sample, among all layers and samples of one part of a pixel. Layer emission
/// does not count: its bright samples are edges of what the camera sees, not outliers.
struct BrightestSample {
  Rgb radiance{0.0f};   ///< W/m^2/sr
  Rgb second{0.0f};     ///< next brightest value of this layer since it is the brightest layer; 0: none
  float brightest = 0;  ///< sum of the channels of `radiance`
  Layer layer = Layer::specular;
  /// Takes the next sample into account.
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

/// Further samples of a pixel. They only decide whether its brightest sample is an outlier. They are not part of the
/// picture: their number depends on the pixel's own samples and would bias it.
struct FurtherSamples {
  PathParts mean;
  PartCounts count;
};
/// Least number of samples that decides about an outlier. One of four stratified samples of a pixel rightly meets an
/// object that covers a quarter of the pixel; three of 12 further samples then confirm it.
inline constexpr int kJudges = 16;

/// A picture whose pixels have all their samples. Every span holds width * height elements, top row first.
struct SampledPixels {
  int width = 0, height = 0;
  std::span<const PathParts> parts;    ///< means
  std::span<const PartCounts> counts;  ///< number of samples of each part, at least one
  std::span<const BrightestSamples> brightest;
  std::span<const std::uint8_t> mask;  ///< 0: the pixel neither gives nor receives light; empty: all pixels do both
  /// The error that a pixel may have, by the radiance around it (both W/m^2/sr). Where it is 0, the pixel gives no
  /// light. Thread-safe.
  std::function<double(double)> error;
  std::unordered_map<std::size_t, FurtherSamples> further{};  ///< by pixel
  /// True if the pixel may give and receive light.
  bool takes_part(std::size_t pixel) const { return mask.empty() || mask[pixel] != 0; }
};

/// The error that each pixel may have [W/m^2/sr], from the median radiance of the pixel and the 24 around it, which an
/// outlier does not change. 0 for pixels without a surface and outside the mask: these neither give nor receive light.
std::vector<double> allowed_errors(const SampledPixels& samples, const std::vector<Layers>& pixels);

/// Energy-preserving filter of outliers [Rushmeier, Ward: Energy preserving non-linear filters, SIGGRAPH 1994],
/// docs/methods/outliers.md.
///
/// Each of the two brightest samples of a part keeps a contribution of at most
///     allowed error + max(mean of the pixel's other samples, mean of the 24 pixels around), in its layer.
/// The other samples include FurtherSamples. The excess is the outlier. Outliers are spread in ascending order of their
/// light, each over the smallest box that fulfils two conditions: its light per pixel is below the allowed error, and
/// the squared error that it adds is less than the visible squared error of the bright pixel. An outlier stays in its
/// pixel if no box does.
///
/// A pixel receives light in proportion to its allowed error; a pixel without a surface (coverage 0) neither gives nor
/// receives. The sum of a layer over the picture stays the same up to rounding. Returns the light that was spread over
/// the light of the picture. errors: allowed_errors().
double spread_outliers(const SampledPixels& samples, const std::vector<double>& errors, std::vector<Layers>& pixels);

/// Pixels, in ascending order, with an outlier in a part of fewer than kJudges samples: further samples shall decide
/// about it. errors: allowed_errors().
std::vector<std::size_t> pixels_to_judge(const SampledPixels& samples, const std::vector<Layers>& pixels,
                                         const std::vector<double>& errors);

}  // namespace tempolux
