// lib/aqm/compared.h -- one frame beside its reference: the planes of a layer, checked to fit each other.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "lib/image/image.h"

namespace tempolux {

/// An image and the name its errors are reported under. The image outlives what is made of it.
struct NamedImage {
  const Image* image = nullptr;
  std::string name;
};

/// Names and samples of a layer's channels.
struct LayerPlanes {
  std::vector<std::string> suffixes;  ///< "R", "G", "B"; "X", "Y", "Z"; "" for a single channel
  std::vector<const std::vector<float>*> planes;
};

/// The float channels of a layer: LAYER.R .G .B; or the one channel LAYER ("Z"); or all channels LAYER.*
/// ("N"). Layer "" is R, G, B, or Y alone. Throws InputError that lists the layers and channels there are.
LayerPlanes layer_planes(const NamedImage& image, const std::string& layer);

/// A frame x, its reference r and what of them counts. References are views of images that outlive it.
struct Compared {
  int width = 0, height = 0;
  std::vector<std::string> channels;  ///< suffixes of the planes
  std::vector<const std::vector<float>*> test, reference;
  std::vector<const std::vector<float>*> second;        ///< the other half of the reference; empty: one reference
  std::vector<const std::vector<float>*> smooth;        ///< stands for r in relMSE's denominator; empty: r itself
  const std::vector<std::uint32_t>* objects = nullptr;  ///< id.object of x, else of r; nullptr: unknown
  std::vector<std::uint8_t> counted;                    ///< per pixel; empty: all count

  bool halves() const { return !second.empty(); }
  bool counts(std::size_t pixel) const { return counted.empty() || counted[pixel] != 0; }
  /// r at a pixel: the reference, or the mean of its halves.
  double reference_at(std::size_t channel, std::size_t pixel) const {
    const double first = (*reference[channel])[pixel];
    return halves() ? 0.5 * (first + double((*second[channel])[pixel])) : first;
  }
  /// What r is taken for in relMSE's denominator.
  double scale_at(std::size_t channel, std::size_t pixel) const {
    return smooth.empty() ? reference_at(channel, pixel) : double((*smooth[channel])[pixel]);
  }
};

/// The inputs of one comparison; second, smooth and mask may be absent (image == nullptr).
struct ComparedInputs {
  NamedImage test, reference, second, mask;
  std::string layer;
  NamedImage smooth = {}, except = {};
};

/// Lays a frame beside its reference. Pixels where all channels of `mask` are 0, or one of `except` is not, do not
/// count. Throws InputError, naming file and remedy, if sizes or channels differ, the layer is missing, no pixel
/// counts, or a sample that counts is infinite or not a number.
Compared compare_layers(const ComparedInputs& inputs);

}  // namespace tempolux
