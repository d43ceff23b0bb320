// lib/image/texture_wrap.h -- what a texture shows beyond [0, 1].
#pragma once

#include <cstdint>

namespace tempolux {

enum class TextureWrap : std::uint8_t { repeat, mirrored, clamp };

}  // namespace tempolux
