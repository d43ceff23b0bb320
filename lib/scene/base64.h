// lib/scene/base64.h -- the payload of data URIs.
#pragma once

#include <optional>
#include <string_view>
#include <vector>

namespace tempolux::gltf {

/// The bytes that base64 text stands for (RFC 4648), padding allowed and not needed; nothing if it holds other
/// characters.
std::optional<std::vector<unsigned char>> base64_bytes(std::string_view text);

}  // namespace tempolux::gltf
