// modules/decode.h -- the three libraries behind tempolux-decode, one file each. What the settings mean:
// lib/core/unpack.h.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace tempolux {

/// Fills `unpacked`, which has the size that was asked for. Returns what is wrong with the data, "" if nothing.
using Decode = std::string(std::span<const std::uint32_t> settings, std::span<const unsigned char> packed,
                           std::span<unsigned char> unpacked);

Decode decode_draco;
Decode decode_meshopt;
Decode decode_webp;

}  // namespace tempolux
