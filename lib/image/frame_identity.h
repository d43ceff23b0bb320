// lib/image/frame_identity.h -- attributes that identify the scene and the state that a frame shows
// (formats/frames/frames.md 3).
#pragma once

#include <string_view>

#include "formats/identity.h"
#include "lib/image/image.h"

namespace tempolux {

inline constexpr std::string_view kIdentityPrefix = "tempolux:identity.";  ///< prefix of a concern's name

/// Writes the attributes tempolux:identity.CONCERN for all concerns of the scene; an unknown hash becomes an empty
/// text.
void set_identity(Image& image, const formats::Identity& identity);

/// Reads what set_identity() wrote; the hash of a missing attribute is unknown. The result is valid for frame 0
/// alone, whatever tempolux:frame contains. Without any hash it is not known().
formats::Identity identity_in(const Image& image);

}  // namespace tempolux
