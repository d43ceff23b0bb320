// lib/image/image.h -- an image with named channels.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <optional>
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

/// A frame. Channels keep the order in which they were added; files sort them by name.
struct Image {
  int width = 0, height = 0;
  std::vector<Channel> channels;
  std::map<std::string, std::string> text;  ///< string attributes, "tempolux:history" ...
  std::map<std::string, double> numbers;    ///< "framesPerSecond", "tempolux:frame" ...
  /// OpenEXR's convention: row vectors, row-major; "worldToCamera", "worldToNDC".
  std::map<std::string, std::array<double, 16>> matrices;

  std::size_t pixel_count() const { return std::size_t(width) * std::size_t(height); }
  const Channel* find(std::string_view name) const;  ///< nullptr if absent
  Channel* find(std::string_view name);
  /// Adds a channel of zeros and returns it. The reference is valid until the next call; samples stay where they are.
  Channel& add(std::string name);
  Channel& add_ids(std::string name);
  /// The three planes LAYER.R, .G, .B; layer "" is R, G, B. Throws InputError listing the layers if missing.
  std::array<const std::vector<float>*, 3> rgb(const std::string& layer) const;
  std::vector<std::string> layers() const;  ///< layers with .R .G .B; "" comes first if R G B exist
};

}  // namespace tempolux
