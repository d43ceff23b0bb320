// lib/image/cryptomatte.h -- mattes by name: ranked shares of a pixel [Friedman and Jones 2015; Cryptomatte 1.2].
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "lib/image/image.h"

namespace tempolux {

/// Layers of mattes in our frames. Their channels are LAYER00.R .G .B .A, LAYER01.R ...
inline constexpr const char *kObjectMattes = "CryptoObject", *kMaterialMattes = "CryptoMaterial";
inline constexpr std::size_t kMatteRanks = 6;  ///< pairs of name and share in a pixel: the specification's default

/// MurmurHash3_x86_32 of the bytes, seed 0.
std::uint32_t murmur_hash(std::string_view bytes);
/// The bits of the float that stands for a name in a channel: murmur_hash(), with bit 23 flipped if the exponent would
/// be 0 or 255. The float is a normal number.
std::uint32_t matte_bits(std::string_view name);

/// A name for each matte, all different. Control characters are blanks, as in tempolux:objects. A missing name becomes
/// "KIND N", and a name that an earlier one has gets "#N" at its end; N is the index.
std::vector<std::string> matte_names(const std::vector<std::string>& names, const std::string& kind);

/// What a pixel shows of one matte.
struct MatteCount {
  std::uint32_t number = 0;   ///< index into the names
  std::uint32_t samples = 0;  ///< camera samples of the pixel that see it
};

/// The channels of a layer of mattes, all 0 at first.
class MatteChannels {
 public:
  /// Adds the channels to the image. `names`: all different, not empty.
  MatteChannels(const char* layer, const std::vector<std::string>& names, Image& image);
  /// Sets a pixel of `total` samples. Sorts `counts`: the most samples first, equal ones by number. The first
  /// kMatteRanks of them are stored with their shares of `total`, rounded down to float32, so that the shares of a
  /// pixel never add up to more than 1. Safe for several threads with different pixels.
  void set(std::size_t pixel, std::span<MatteCount> counts, std::uint32_t total);
  /// Adds the attributes cryptomatte/KEY/name, hash, conversion and manifest. KEY is seven digits of the hash of
  /// the layer's name. The manifest lists the names of this layer that the pixels show.
  void describe(Image& image) const;

 private:
  std::string layer_;
  const std::vector<std::string>& names_;
  std::vector<std::uint32_t> bits_;           ///< by number
  std::vector<float*> hash_planes_, shares_;  ///< by rank
  std::size_t pixels_;
};

/// True if a channel of the image is a matte (is_matte).
bool has_mattes(const Image& image);

/// A layer of mattes that attributes describe, ours or another program's.
struct MatteLayer {
  std::string name;
  std::string manifest;   ///< JSON; "": none
  std::size_t ranks = 0;  ///< half the number of the layer's channels; 0 if the image has none of them
};
std::vector<MatteLayer> matte_layers_in(const Image& image);

/// True for an attribute of a layer of mattes of which the image has no channel, as after channels were left out.
bool describes_missing_mattes(const Image& image, std::string_view attribute);

}  // namespace tempolux
