// lib/aqm/compared.h -- a frame and its reference: the planes of a layer, checked to match each other.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "lib/image/image.h"

namespace tempolux {

/// An image and its name in messages. The image must outlive all that refers to it.
struct NamedImage {
  const Image* image = nullptr;
  std::string name;
};

/// Names and samples of a layer's channels.
struct LayerPlanes {
  std::vector<std::string> suffixes;  ///< "R", "G", "B"; "X", "Y", "Z"; "" for a single channel
  std::vector<const std::vector<float>*> planes;
};

/// The float channels of a layer: LAYER.R .G .B; or the one channel LAYER ("Z"); or all channels LAYER.* ("N"). Layer
/// "" is R, G, B, or Y alone. Throws InputError that lists the existing layers and channels.
LayerPlanes layer_planes(const NamedImage& image, const std::string& layer);

/// A frame x, its reference r, and the pixels that count. Refers to images, which must outlive this object.
struct Compared {
  int width = 0, height = 0;
  std::vector<std::string> channels;  ///< suffixes of the planes
  std::vector<const std::vector<float>*> test, reference;
  std::vector<const std::vector<float>*> second;  ///< the reference's other half; empty: the reference is one image
  std::vector<const std::vector<float>*> smooth;  ///< replaces r in relMSE's denominator; empty: r itself
  const std::vector<std::uint32_t>* objects = nullptr;  ///< id.object of x, or else of r; nullptr: unknown
  std::vector<std::uint8_t> counted;                    ///< by pixel; empty: all count

  bool halves() const { return !second.empty(); }
  bool counts(std::size_t pixel) const { return counted.empty() || counted[pixel] != 0; }
  /// r at a pixel: the reference, or the mean of its halves.
  double reference_at(std::size_t channel, std::size_t pixel) const {
    const double first = (*reference[channel])[pixel];
    return halves() ? 0.5 * (first + double((*second[channel])[pixel])) : first;
  }
  /// The value of r in relMSE's denominator.
  double scale_at(std::size_t channel, std::size_t pixel) const {
    return smooth.empty() ? reference_at(channel, pixel) : double((*smooth[channel])[pixel]);
  }
};

/// The inputs of one comparison; second, smooth and mask may be missing (image == nullptr).
struct ComparedInputs {
  NamedImage test, reference, second, mask;
  std::string layer;
  NamedImage smooth = {}, except = {};
};

/// Selects the planes of a frame and its reference. Pixels where all channels of `mask` are 0, or one of `except` is
/// not 0, do not count. Throws InputError, naming file and remedy, if sizes or channels differ, the layer is missing,
/// no pixel counts, or a sample that counts is infinite or NaN.
Compared compare_layers(const ComparedInputs& inputs);

}  // namespace tempolux
