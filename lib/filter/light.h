// lib/filter/light.h -- the filter's view of a frame: light by group of layers, without texture, in two halves with
// uncorrelated noise.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "lib/filter/surfaces.h"

namespace tempolux {

/// Light by layer and pixel, with its weights and the guide that other pixels compare it by.
struct Light {
  std::vector<ColourPlane> layers;  ///< radiance over albedo; empty planes: black everywhere
  Plane weight;                     ///< number of pixels the light was averaged from; 0: no pixel that sees one surface
  ColourPlane guide;                ///< sum of the layers, smoothed
  Plane guide_variance;             ///< variance of the guide, summed over channels
};
using BothHalves = std::array<Light, 2>;

/// Layers that are filtered by the same surfaces.
struct LightGroup {
  Surfaces surfaces;
  std::vector<std::string> layers;  ///< names; "" is R G B
  BothHalves raw;                   ///< unfiltered; without guide
  Plane variance;                   ///< of one half's sum of the layers, summed over channels

  LightGroup(const Image& image, bool seen, std::vector<std::string> names);

 private:
  void take_light(const Image& image);
  void take_noise(const Image& image);
};

/// A frame as the filter reads it.
/// Half h of a layer is LAYER + LAYER.noise (0) or LAYER - LAYER.noise (1); the noise of the two is uncorrelated
/// (formats/frames/frames.md). A frame without these channels gets noise of random sign whose square is the variance.
/// The variance is read from the channels diffuse.variance or variance and divided among the layers in proportion to
/// their light; without these, but with albedo, the variance is half the mean squared difference to the four neighbours
/// on the surface; without albedo there is no noise, and the filter only replaces values that are not finite. Values
/// plus and minus random noise of this variance are uncorrelated, too [Oliveira, Lei, Tibshirani: Unbiased risk
/// estimation in the normal means problem via coupled bootstrap techniques, 2021].
class FrameLight {
 public:
  /// Matte light is filtered by the surfaces that the pixel sees; emission and specular light by the surfaces in
  /// mirrors and glass. A frame without layers has R G B only.
  static constexpr std::size_t kGroups = 2;
  /// Throws InputError as check_noise() does.
  explicit FrameLight(const Image& image);
  /// Empty if the group has nothing to filter.
  const std::optional<LightGroup>& group(std::size_t g) const { return groups_[g]; }

 private:
  std::array<std::optional<LightGroup>, kGroups> groups_;
};

/// Throws InputError if a layer's noise channels are incomplete, or the layer is missing.
void check_noise(const Image& image);
/// True if the frame has channels from which the noise of its matte light can be estimated.
bool knows_noise(const Image& image);
/// True if the filter reads a channel of this name.
bool is_read_to_filter(const std::string& channel);

}  // namespace tempolux
