// lib/scene/base64.h -- decodes the payload of data URIs.
#pragma once

#include <optional>
#include <string_view>
#include <vector>

namespace tempolux::gltf {

/// The bytes that base64 text encodes (RFC 4648); padding is optional. Nullopt if the text has other characters.
std::optional<std::vector<unsigned char>> base64_bytes(std::string_view text);

}  // namespace tempolux::gltf
