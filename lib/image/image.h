// lib/image/image.h -- an image with named channels.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "lib/core/vec.h"

namespace tempolux {

/// One channel: float32 samples, or uint32 for ids. Row 0 is the top.
struct Channel {
  std::string name;                ///< as in formats/frames/frames.md: "R", "indirect.G", "Z", "id.object"
  std::vector<float> values;       ///< width*height, or empty if `ids` is used
  std::vector<std::uint32_t> ids;  ///< width*height, or empty
  bool operator==(const Channel&) const = default;
};

/// An image. Channels keep the order in which they were added; files sort them by name.
struct Image {
  int width = 0, height = 0;
  std::vector<Channel> channels;
  std::map<std::string, std::string> text;  ///< string attributes, "tempolux:history" ...
  std::map<std::string, double> numbers;    ///< "framesPerSecond", "tempolux:frame" ...
  /// "worldToCamera", "worldToNDC"; for row vectors (p' = p M, OpenEXR's convention), row after row.
  std::map<std::string, std::array<double, 16>> matrices;

  std::size_t pixel_count() const { return std::size_t(width) * std::size_t(height); }
  const Channel* find(std::string_view name) const;  ///< nullptr if absent
  Channel* find(std::string_view name);
  /// Adds a channel of zeros and returns it. The reference is valid until the next call; samples stay where they are.
  Channel& add(std::string name);
  Channel& add_ids(std::string name);
  /// The three planes LAYER.R, .G, .B; layer "" means R, G, B. Throws InputError that lists the layers if one is
  /// missing.
  std::array<const std::vector<float>*, 3> rgb(const std::string& layer) const;
  std::vector<std::string> layers() const;  ///< layers with .R .G .B, without mattes; "" comes first if R G B exist
};

/// For each pixel, 1 if any channel of the image is not 0, else 0 (formats/mask/mask.md).
std::vector<std::uint8_t> nonzero_pixels(const Image& image);
/// 32 hexadecimal digits: a hash of size, channel names and the bits of samples, so -0 differs from 0. The order of
/// channels, attributes and compression do not change it.
std::string digest_of(const Image& image);
/// Name of a layer's channel: "indirect.G"; for the layer "" the component alone.
std::string layer_channel(const std::string& layer, const char* component);
/// "pixel (X, Y)" for messages; counted from the top left.
std::string pixel_name(std::size_t pixel, int width);

}  // namespace tempolux
