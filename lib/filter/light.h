// lib/filter/light.h -- the light of a frame as the filter takes it: by group of layers, without texture, in two halves
// whose noise is uncorrelated.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "lib/filter/surfaces.h"

namespace tempolux {

/// Light of pixels by layer, with what it is worth and what others compare it by.
struct Light {
  std::vector<ColourPlane> layers;  ///< radiance over albedo; empty planes: black everywhere
  Plane weight;          ///< in pixels: 1 for each that the light was taken from; 0: none that sees one surface
  ColourPlane guide;     ///< sum of the layers, smoothed
  Plane guide_variance;  ///< of that, summed over channels
};
using BothHalves = std::array<Light, 2>;

/// Layers that share surfaces.
struct LightGroup {
  Surfaces surfaces;
  std::vector<std::string> layers;  ///< by name; "" is R G B
  BothHalves raw;                   ///< as samples bring it; no guide
  Plane variance;                   ///< of one half, of the sum of the layers, summed over channels

  LightGroup(const Image& image, bool seen, std::vector<std::string> names);

 private:
  void take_light(const Image& image);
  void take_noise(const Image& image);
};

/// A frame as the filter sees it.
///
/// Half h of a layer is LAYER + LAYER.noise (0) or LAYER - LAYER.noise (1); the two are uncorrelated
/// (formats/frames/frames.md). A frame without such channels has noise of a made-up sign whose square is the variance:
/// that of the channels diffuse.variance or variance, shared out among the layers as their light is; or, in frames that
/// say nothing of noise but have albedo, half the mean squared difference to the four pixels beside, over the surface;
/// else none: then no more is done than to fill what is no number. Values plus and less such a number are uncorrelated,
/// too [Oliveira, Lei, Tibshirani: Unbiased risk estimation in the normal means problem via coupled bootstrap
/// techniques, 2021].
class FrameLight {
 public:
  /// Matte light by what the pixel sees; emission and specular by what mirrors and glass show. R G B alone where a
  /// frame has no layers.
  static constexpr std::size_t kGroups = 2;
  /// InputError as check_noise().
  explicit FrameLight(const Image& image);
  /// Nothing to be filtered in the group: empty.
  const std::optional<LightGroup>& group(std::size_t g) const { return groups_[g]; }

 private:
  std::array<std::optional<LightGroup>, kGroups> groups_;
};

/// InputError if a layer's noise is not all there, or the layer is not.
void check_noise(const Image& image);
/// Does a frame say anything by which its matte light's noise is known?
bool knows_noise(const Image& image);
/// Does the filter read a channel of this name?
bool is_read_to_filter(const std::string& channel);

}  // namespace tempolux
