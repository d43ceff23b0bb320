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

}  // namespace tempolux
