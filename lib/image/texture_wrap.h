// lib/image/texture_wrap.h -- how a texture continues outside [0, 1].
#pragma once

#include <cstdint>

namespace tempolux {

/// Continuation of a texture: its copies, its mirror images and copies in turn, or its edge.
enum class TextureWrap : std::uint8_t { repeat, mirrored, clamp };

}  // namespace tempolux
