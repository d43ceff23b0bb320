// modules/decode.h -- the four decoders of tempolux-decode, one file each. lib/core/unpack.h explains their settings.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace tempolux {

/// Fills `unpacked`, which has the requested size. Returns an error message, or "" on success.
using Decode = std::string(std::span<const std::uint32_t> settings, std::span<const unsigned char> packed,
                           std::span<unsigned char> unpacked);

Decode decode_draco;
Decode decode_meshopt;
Decode decode_webp;
Decode decode_avif;

/// Size of the image that a request for an image format asks for, in pixels, and its channels.
struct ImageRequest {
  std::uint64_t width = 0, height = 0, channels = 0;
  /// Returns an error message that names the format, or "". most: largest width and height of the format.
  /// fewest_channels: 4 if the decoder always returns alpha, else 3.
  std::string read(const std::string& format, std::uint64_t most, std::uint64_t fewest_channels,
                   std::span<const std::uint32_t> settings, std::size_t unpacked_size) {
    if (settings.size() != 3) return "got a request that is no request for " + format;
    width = settings[0], height = settings[1], channels = settings[2];
    const bool fits = width >= 1 && height >= 1 && width <= most && height <= most && channels >= fewest_channels &&
                      channels <= 4 && unpacked_size == width * height * channels;
    return fits ? "" : "got a size that no " + format + " image has";
  }
};

}  // namespace tempolux
