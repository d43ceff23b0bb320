// lib/render/pixel_variance.h -- how uncertain each pixel's mean is, told by two halves of its samples.
#pragma once

#include <string>
#include <vector>

#include "lib/image/image.h"
#include "lib/render/path_tracer.h"

namespace tempolux {

/// Sums over the samples of one pixel by part (PathParts), of each pass the first half and the second half apart. Samples of one pixel are stratified
/// together, so that their mean errs by less than that of independent ones. Each half of them, in their order, is nearly as well
/// stratified: the difference of the two halves' means knows it, where the spread of single samples does not.
struct SampleHalves {
  struct Sum {
    Rgb image{0.0f};     ///< radiance of all layers [W/m^2/sr]
    Rgb diffuse{0.0f};   ///< of direct, caustic and indirect: what the filter st-filter filters
    float count = 0;     ///< samples
    void add(const Layers& sample, float samples);
  };
  struct Half {
    Sum own, lit, onward;
  };
  Half half[2];

  /// Sample `rank` of a pass of `count`. A pass of one goes to the half that has fewer.
  void add(int rank, int count, const PathParts& sample, const PathEffort& effort);
  SampleHalves& operator+=(const SampleHalves& more);
  float samples() const { return half[0].own.count + half[1].own.count; }
  /// Variance of the mean over both halves [(W/m^2/sr)^2], unbiased for independent samples: with a, b the halves' means and
  /// n_a, n_b their counts (a - b)^2 n_a n_b / (n_a + n_b)^2, where (a - b) (n_a n_b)^(1/2) / (n_a + n_b) is the sum over the parts.
  /// Of a part of which a half is empty nothing is known: 0.
  Rgb variance(Rgb Sum::*part) const;
};

/// Is one of the channels asked for that halves are kept for?
bool wants_sample_halves(const std::vector<std::string>& channels);

/// Adds what is asked for of "variance" (variance.R .G .B: of R G B), "diffuse.variance" (diffuse.variance.R .G .B: of the sum of
/// direct, caustic and indirect) and "samples".
/// `halves` holds one element for each pixel of `image`.
void add_variance_channels(const std::vector<SampleHalves>& halves, const std::vector<std::string>& channels, Image& image);

}  // namespace tempolux
