// lib/render/pixel_variance.h -- variance of each pixel's mean, from two halves of its samples.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "lib/core/parallel_each.h"
#include "lib/image/image.h"
#include "lib/render/path_tracer.h"

namespace tempolux {

/// Sums over the samples of one pixel by part (PathParts), for each half of the samples. Samples of one pixel are
/// stratified together, so their mean has less variance than a mean of independent samples. The difference between the
/// means of two halves includes this gain, because each half is nearly as well stratified; the variance of single
/// samples does not include the gain.
struct SampleHalves {
  struct Sum {
    Layers radiance;  ///< [W/m^2/sr]
    float count = 0;  ///< samples
  };
  std::array<std::array<Sum, 3>, 2> half;  ///< of each half the sums of own, lit and onward

  /// Adds a sample to half h, 0 or 1.
  void add(int h, const PathParts& sample, const PathEffort& effort);
  SampleHalves& operator+=(const SampleHalves& more);
  float samples() const { return half[0][0].count + half[1][0].count; }
  /// Half the difference between the halves in layer l [W/m^2/sr]: the sum over the parts of
  /// (a - b) (n_a n_b)^(1/2) / (n_a + n_b), with the means a, b of the halves and their counts n_a, n_b. For
  /// independent samples, the mean of its square is the variance of the mean over both halves. A part with an empty
  /// half adds 0.
  Rgb difference(std::size_t l) const;
  /// Mean over both halves in layer l [W/m^2/sr].
  Rgb mean(std::size_t l) const;
  /// Square of the sum of difference() over `layers` [(W/m^2/sr)^2], at most 3.4e38.
  Rgb variance(std::span<const Layer> layers) const;
};

inline constexpr std::array<Layer, 6> kImageLayers{Layer::emission, Layer::specular, Layer::direct,
                                                   Layer::caustic,  Layer::indirect, Layer::volume};
/// The layers whose sum st-filter filters.
inline constexpr std::array<Layer, 3> kDiffuseLayers{Layer::direct, Layer::caustic, Layer::indirect};

/// True if a requested channel needs LayerImage::sample_halves.
bool wants_sample_halves(const std::vector<std::string>& channels);

/// Adds the channels PREFIX + R, G, B with the values of colour(pixel).
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

/// Adds the requested groups of channels:
/// - "variance": variance.R .G .B, the variance of R G B.
/// - "diffuse.variance": diffuse.variance.R .G .B, the variance of the sum of direct, caustic and indirect.
/// - "halves": LAYER.noise.R .G .B of each layer (volume only with media), and halves.confirmed
/// (LayerImage::confirmed).
/// - "samples": the number of camera rays.
///
/// LAYER.noise = n: LAYER + n and LAYER - n are uncorrelated halves, and the mean of n^2 is the variance of LAYER. n is
/// SampleHalves::difference d times s, the root of LayerImage::difference_share. The plain halves m + d and m - d are
/// stratified together and err in opposite ways around their mean m. The halves are exchangeable, so d is uncorrelated
/// with m, and m + s d and m - s d have the covariance Var(m) - s^2 Var(d): 0 for s^2 = Var(m) / Var(d). Light that
/// spread_outliers took from a layer is also taken from |n|. LayerImage::stored_noise of the layer is added to n.
void add_variance_channels(const LayerImage& layers, const std::vector<std::string>& channels, Image& image);

}  // namespace tempolux
