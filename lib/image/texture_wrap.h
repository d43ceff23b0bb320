// lib/image/texture_wrap.h -- how a texture continues outside [0, 1].
#pragma once

#include <cstdint>

namespace tempolux {

enum class TextureWrap : std::uint8_t { repeat, mirrored, clamp };

}  // namespace tempolux
