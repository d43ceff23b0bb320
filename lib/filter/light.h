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

/// The layers of matte light, and the layers of light that lamps emit and that mirrors and glass show.
inline constexpr std::array<const char*, 3> kMatteLayers{"direct", "caustic", "indirect"};
inline constexpr std::array<const char*, 2> kSeenLayers{"emission", "specular"};

/// Light by layer and pixel, with its weights, and the guide by which pixels are compared.
struct Light {
  std::vector<ColourPlane> layers;  ///< radiance over albedo; empty planes: black everywhere
  Plane weight;          ///< number of pixels from which the light was averaged; 0: none of them sees a single surface
  ColourPlane guide;     ///< sum of the layers, smoothed
  Plane guide_variance;  ///< variance of the guide, summed over channels
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
/// Half 0 of a layer is LAYER + LAYER.noise, half 1 is LAYER - LAYER.noise. The noise of the two halves is uncorrelated
/// (formats/frames/frames.md). If no layer of matte light has channels of noise, the filter makes up noise n of random
/// sign for these layers. The square of n is an estimate of the pixel's variance:
/// - With the channels diffuse.variance or variance, n is the standard deviation of the sum of the layers. Each layer
///   gets the share of n that it has in the light.
/// - Without these channels, but with albedo, the variance is half the mean squared difference to the four neighbours
///   on the surface.
/// - Without all of these channels n is 0, and the filter only replaces values that are not finite.
/// The halves light + n and light - n are uncorrelated, too, if n has this variance [Oliveira, Lei, Tibshirani:
/// Unbiased risk estimation in the normal means problem via coupled bootstrap techniques, 2021].
class FrameLight {
 public:
  /// Group 0 is matte light, which is filtered by the surfaces that the pixel sees. Group 1 is emission and specular
  /// light, which is filtered by the surfaces seen in mirrors and glass. In a frame without layers R, G and B are group
  /// 0.
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
