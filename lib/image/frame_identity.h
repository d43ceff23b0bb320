// lib/image/frame_identity.h -- which state of which scene a frame shows: its attributes (formats/frames/frames.md 3).
#pragma once

#include <string_view>

#include "formats/identity.h"
#include "lib/image/image.h"

namespace tempolux {

inline constexpr std::string_view kIdentityPrefix = "tempolux:identity.";  ///< before a concern's name

/// Writes the attributes tempolux:identity.CONCERN for all concerns of the scene; an unknown hash is written empty.
void set_identity(Image& image, const formats::Identity& identity);

/// What set_identity() wrote; attributes that are absent are unknown. Valid for frame 0 alone, whatever
/// tempolux:frame says; not known() if there is no hash at all.
formats::Identity identity_in(const Image& image);

}  // namespace tempolux
