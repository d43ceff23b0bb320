// lib/render/pixel_variance.h -- the uncertainty of each pixel's mean, from two halves of its samples.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "lib/core/parallel_each.h"
#include "lib/image/image.h"
#include "lib/render/path_tracer.h"

namespace tempolux {

/// Sums over the samples of one pixel by part (PathParts), for the first and the second half of the samples. Samples of
/// one pixel are stratified together, so their mean errs by less than that of independent samples. Each half of a pass
/// is nearly as well stratified: the difference of the halves' means includes this gain, but the spread of single
/// samples does not.
struct SampleHalves {
  struct Sum {
    Layers radiance;  ///< [W/m^2/sr]
    float count = 0;  ///< samples
    void add(const Layers& sample, float samples);
  };
  struct Half {
    Sum own, lit, onward;
  };
  Half half[2];

  /// Adds a sample of half h, 0 or 1.
  void add(int h, const PathParts& sample, const PathEffort& effort);
  SampleHalves& operator+=(const SampleHalves& more);
  float samples() const { return half[0].own.count + half[1].own.count; }
  /// Half the difference of the halves in layer l [W/m^2/sr]: the sum over the parts of (a - b) (n_a n_b)^(1/2) / (n_a
  /// + n_b), with a, b the halves' means and n_a, n_b their counts. For independent samples the mean of its square is
  /// the variance of the mean over both halves. A part with an empty half contributes 0.
  Rgb difference(std::size_t l) const;
  /// Mean over both halves in layer l [W/m^2/sr].
  Rgb mean(std::size_t l) const;
  /// Square of the difference() of the sum of `layers` [(W/m^2/sr)^2].
  Rgb variance(std::span<const Layer> layers) const;
};

inline constexpr std::array<Layer, 6> kImageLayers{Layer::emission, Layer::specular, Layer::direct,
                                                   Layer::caustic,  Layer::indirect, Layer::volume};
/// The layers that st-filter filters.
inline constexpr std::array<Layer, 3> kDiffuseLayers{Layer::direct, Layer::caustic, Layer::indirect};

/// True if one of the requested channels needs the halves of samples.
bool wants_sample_halves(const std::vector<std::string>& channels);

/// Adds the channels PREFIX + R, G, B with colour(pixel) of each pixel.
template <class Colour>
void add_colour(const std::string& prefix, Image& image, const Colour& colour) {
  std::array<float*, 3> to{};
  for (std::size_t c = 0; c < 3; ++c) to[c] = image.add(prefix + "RGB"[c]).values.data();
  parallel_each(image.pixel_count(), 4096, [&](std::size_t p) {
    const Rgb value = colour(p);
    for (std::size_t c = 0; c < 3; ++c) to[c][p] = value[int(c)];
  });
}

struct LayerImage;

/// Adds the requested ones of "variance" (variance.R .G .B, the variance of R G B), "diffuse.variance"
/// (diffuse.variance.R .G .B, the variance of the sum of direct, caustic and indirect), "halves" (LAYER.noise.R .G .B
/// of each layer, of volume only with media; halves.confirmed, LayerImage::confirmed) and "samples".
///
/// LAYER.noise = n: LAYER + n and LAYER - n are uncorrelated halves, and the mean of n^2 is the variance of LAYER. n is
/// the half difference d of the samples' halves times the root of LayerImage::difference_share. Halves a and b that are
/// stratified together err in opposite ways around their mean m. As a and b are exchangeable, d is uncorrelated with m,
/// so m + s d and m - s d have the covariance Var(m) - s^2 Var(d), which is 0 for s^2 = Var(m) / Var(d). Light that
/// spread_outliers took from a layer is also taken from |n|. The noise of stored light is added to n of its
/// layer (LayerImage::stored_noise).
void add_variance_channels(const LayerImage& layers, const std::vector<std::string>& channels, Image& image);

}  // namespace tempolux
