// lib/render/pixel_variance.h -- how uncertain each pixel's mean is, told by two halves of its samples.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "lib/image/image.h"
#include "lib/render/path_tracer.h"

namespace tempolux {

/// Sums over the samples of one pixel by part (PathParts), of the first half and of the second half apart. Samples of one pixel are
/// stratified together, so that their mean errs by less than that of independent ones. Each half of a pass, in their order, is nearly as
/// well stratified: the difference of the two halves' means knows it, where the spread of single samples does not. With
/// FrameOptions::independent_halves the halves are samples of even and of odd number instead.
struct SampleHalves {
  struct Sum {
    Layers radiance;     ///< [W/m^2/sr]
    float count = 0;     ///< samples
    void add(const Layers& sample, float samples);
  };
  struct Half {
    Sum own, lit, onward;
  };
  Half half[2];

  /// A sample of half h, 0 or 1.
  void add(int h, const PathParts& sample, const PathEffort& effort);
  SampleHalves& operator+=(const SampleHalves& more);
  /// Gives both halves their common mean in a layer.
  void join(Layer layer);
  float samples() const { return half[0].own.count + half[1].own.count; }
  /// Mean radiance of layer l over half h [W/m^2/sr]; of a part without samples in this half 0.
  Rgb mean(int h, std::size_t l) const;
  /// Variance of the mean over both halves [(W/m^2/sr)^2], unbiased for independent samples: with a, b the halves' means and
  /// n_a, n_b their counts (a - b)^2 n_a n_b / (n_a + n_b)^2, where (a - b) (n_a n_b)^(1/2) / (n_a + n_b) is the sum over the parts.
  /// Of a part of which a half is empty nothing is known: 0. Of the sum of `layers`.
  Rgb variance(std::span<const Layer> layers) const;
};

inline constexpr std::array<Layer, 6> kImageLayers{Layer::emission, Layer::specular, Layer::direct, Layer::caustic, Layer::indirect, Layer::volume};
/// What the filter st-filter filters.
inline constexpr std::array<Layer, 3> kDiffuseLayers{Layer::direct, Layer::caustic, Layer::indirect};

/// Is one of the channels asked for that halves are kept for?
bool wants_sample_halves(const std::vector<std::string>& channels);

/// Is "halves" asked for?
bool wants_independent_halves(const std::vector<std::string>& channels);

/// Adds what is asked for of "variance" (variance.R .G .B: of R G B), "diffuse.variance" (diffuse.variance.R .G .B: of the sum of
/// direct, caustic and indirect), "halves" (LAYER.a.R .G .B and LAYER.b.R .G .B of each layer, of volume only with `media`) and "samples".
/// `halves` holds one element for each pixel of `image`.
void add_variance_channels(const std::vector<SampleHalves>& halves, bool media, const std::vector<std::string>& channels, Image& image);

}  // namespace tempolux
